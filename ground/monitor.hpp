// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <deque>
#include <iosfwd>
#include <string>

#include "ground/ground_link.hpp"

namespace rosflight::ground {

/// What a vehicle sends, as text. Reads a session and never sends.
class Monitor final : public companion::Listener {
 public:
  static constexpr std::size_t kTexts = 8;  ///< Status texts that are kept.

  struct Text {
    Time time{};
    link::StatusText line;
  };

  /// @param session  must outlive this.
  explicit Monitor(Session& session) : session_(session) { session_.add(*this); }
  ~Monitor() override { session_.remove(*this); }
  Monitor(const Monitor&) = delete;
  Monitor& operator=(const Monitor&) = delete;

  void on_event(const companion::Event& event) override;

  /// A screen of about 25 lines, each ended by a line feed.
  std::string screen();
  /// One line without line feed: attitude, battery, GNSS, RC, state and link.
  std::string line();
  /// One JSON object without line feed, with the status texts since the last call. What was not received is null.
  std::string json();

 private:
  std::string link_text();
  std::string state_text() const;

  Session& session_;
  std::deque<Text> texts_;
  std::deque<Text> new_texts_;
};

struct MonitorOptions {
  double period_s{0.2};
  bool once{false};
  bool json{false};
  bool in_place{
      false};  ///< A terminal: the screen is drawn over the last one; otherwise a line each period.
};

/// Shows the vehicle until a person stops it, or once. A lost connection is shown, not an end.
/// @returns the exit code 0. @throws Stopped  before the first output.
int monitor(GroundLink& link, const MonitorOptions& options, std::ostream& out);

}  // namespace rosflight::ground
