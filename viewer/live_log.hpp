// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <optional>

#include "log/flight_log_topics.hpp"
#include "log/log_observer.hpp"
#include "web/server/live_data.hpp"

namespace rosflight::viewer {

/// Shows viewers of the page what is logged.
class LiveLog final : public log::LogObserver {
 public:
  /// @param data  must outlive this.
  explicit LiveLog(web::server::LiveData& data) : data_{data} {}

  void on_logged(log::Topic topic, std::uint64_t time_ns, log::Bytes cdr) override;
  /// Another flight begins: viewers begin again.
  void restart();

 private:
  web::server::LiveData& data_;
  std::array<std::optional<std::size_t>, log::kTopics.size()> channels_;
};

}  // namespace rosflight::viewer
