// SPDX-License-Identifier: BSD-3-Clause
#include "ground/ground_link.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/transport/socket.hpp"
#include "companion/events.hpp"

namespace rosflight::ground {
namespace {

using namespace std::chrono_literals;

constexpr Time kTurn = 10ms;  // a result or a signal is noticed within it

companion::Session::Options session_options(const GroundLink::Options& options) {
  companion::Session::Options session;
  session.target_system = options.system;
  session.parameters.automatic_list = false;
  session.parameters.list_timeout = options.timeout;
  return session;
}

/// The board sends to this address and nobody receives there yet.
bool is_free_here(const base::LinkAddress& address) {
  try {
    const base::SocketAddress at = base::look_up(address.host, address.port, SOCK_DGRAM);
    const base::FileDescriptor socket = base::new_socket(at.family(), SOCK_DGRAM);
    return socket.valid() && base::bind_socket(socket, at, SOCK_DGRAM);
  } catch (const base::LinkError&) {
    return false;  // an unknown host is reported when the link is opened
  }
}

}  // namespace

base::LinkAddress parse_ground_link(std::string_view text) {
  constexpr std::string_view kPty = "pty:";
  if (text.starts_with(kPty)) {
    return base::parse_link("serial:" + std::string(text.substr(kPty.size())));
  }
  const std::size_t slash = text.find('/');
  if (slash != std::string_view::npos && text.find(':') > slash) {
    return base::parse_link("serial:" + std::string(text));
  }
  base::LinkAddress address = base::parse_link(text);
  if (address.kind != base::LinkAddress::Kind::kUdp) return address;
  if (is_free_here(address)) address.kind = base::LinkAddress::Kind::kUdpServer;
  return address;
}

GroundLink::GroundLink(const Options& options)
    : options_(options),
      runner_(codec_, parse_ground_link(options.link), session_options(options)),
      work_(runner_.io().get_executor()) {
  runner_.on_link_state([this](bool, const std::string& line) { last_line_ = line; });
}

bool GroundLink::run(const std::function<bool()>& done, Time limit, bool stoppable) {
  runner_.start();
  const Time begin = now();
  while (!done()) {
    if (stoppable && options_.stopped && options_.stopped()) throw Stopped();
    const Time left = limit == companion::kNever ? kTurn : begin + limit - now();
    if (left <= Time{}) return false;
    runner_.io().restart();
    runner_.io().run_for(std::min(left, kTurn));
    if (options_.each_turn) options_.each_turn();
  }
  return true;
}

bool GroundLink::run_until(const std::function<bool()>& done, Time limit) {
  return run(done, limit, true);
}

void GroundLink::no_answer(const std::string& what) {
  throw NoAnswer(fmt::format("no answer from {} within {:g} s: {}", name(),
                             companion::to_seconds(timeout()), what));
}

void GroundLink::connect() {
  const auto answered = [this] { return session().connected() || session().refused(); };
  if (!run_until(answered, timeout())) {
    no_answer(last_line_.empty() ? "no heartbeat" : "no heartbeat; " + last_line_);
  }
  if (session().refused()) {
    throw NoAnswer(name() +
                   ": the vehicle speaks lean with other message layouts than this program");
  }
  // Whether it is armed decides what may be done next.
  if (!run_until([this] { return streams().status.count > 0; }, timeout())) {
    no_answer("heartbeats, but no status");
  }
}

void GroundLink::receive_parameters() {
  const auto job = session().parameters().refresh();
  if (wait(job).failed()) no_answer(job.text());
}

void TextLog::on_event(const companion::Event& event) {
  if (const auto* log = std::get_if<companion::LogEvent>(&event)) {
    lines_.emplace_back(companion::text_of(log->line.text));
  }
}

std::string TextLog::last_with(std::string_view part) const {
  const auto found = std::find_if(lines_.rbegin(), lines_.rend(), [part](const std::string& line) {
    return line.find(part) != std::string::npos;
  });
  return found == lines_.rend() ? std::string() : *found;
}

}  // namespace rosflight::ground
