// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/log_view.hpp"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <utility>

#include "base/stop_signal.hpp"
#include "config/strict_yaml.hpp"
#include "viewer/page_server.hpp"

namespace rosflight::viewer {
namespace {

namespace fs = std::filesystem;
using web::server::Contents;

/// Adds the flight; the page learns from offer.json what there is.
void add_flight(const fs::path& input, Contents& contents) {
  const bool folder = fs::is_directory(input);
  const fs::path log = folder ? input / "flight.mcap" : input;
  if (!std::ifstream(log).good() || fs::is_directory(log)) {
    throw config::Error(log.string() +
                        ": found no file that can be read, allowed a flight folder with a log "
                        "(fly without --no-log) or a log (.mcap)");
  }
  // Texts may contain a file name that is no UTF-8.
  const auto text = [](const nlohmann::json& json) {
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  };
  nlohmann::json offer{{"log", "flight/flight.mcap"},
                       {"name", (folder ? fs::absolute(input).lexically_normal() : log).string()}};
  contents.files["flight/flight.mcap"] = log;
  for (const std::string name : {"summary", "analysis"}) {
    const fs::path file = input / (name + ".json");
    if (!folder || !fs::exists(file)) continue;
    const std::string address = "flight/" + name + ".json";
    contents.files[address] = file;
    offer[name] = address;
  }
  contents.texts["offer.json"] = text(offer);
}

}  // namespace

int view_log(const fs::path& input, const web::server::Access& access, std::ostream& out) {
  Contents contents = page_contents();
  add_flight(input, contents);
  const base::SignalWatch watch;
  const auto server = serve(std::move(contents), access);
  out << server->address() << "  (Ctrl-C ends it)" << std::endl;
  wait_for_stop();
  return 0;
}

}  // namespace rosflight::viewer
