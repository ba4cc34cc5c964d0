// SPDX-License-Identifier: BSD-3-Clause
#include "flight/preflight_json.hpp"

#include <chrono>
#include <nlohmann/json.hpp>

namespace rosflight::flight {
namespace {

using Json = nlohmann::ordered_json;

const char* verdict_of(const link::CheckResult& line) {
  switch (static_cast<link::CheckOutcome>(line.result)) {
    case link::CheckOutcome::kPass:
      return "pass";
    case link::CheckOutcome::kWarning:
      return "warning";
    case link::CheckOutcome::kRefuses:
      break;
  }
  return "refuses";
}

/// Without digits that come from binary numbers alone.
double seconds(companion::Time time) {
  return static_cast<double>(std::chrono::round<std::chrono::microseconds>(time).count()) / 1e6;
}

}  // namespace

std::string preflight_json(const companion::CheckList& list, companion::Time start) {
  Json json;
  json["ready"] = list.complete() ? Json(list.ready()) : Json();
  json["checks"] = Json::array();
  for (const auto& [index, line] : list.lines()) {
    json["checks"].push_back({{"time_s", seconds(line.time - start)},
                              {"row", companion::text_of(line.result.name)},
                              {"verdict", verdict_of(line.result)},
                              {"reason", companion::text_of(line.result.reason)}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace rosflight::flight
