// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "companion/parameter_table.hpp"
#include "companion/port.hpp"

namespace rosflight::companion {

/// Receives the whole parameter table over a link that may lose messages.
///
/// Requests the list every `ask_period` until a value arrives (a later request would make the FCU
/// begin again). When no value arrives for `stall`, or the last index has arrived, it requests the
/// missing values, `window` indices at a time: the next batch when this one is answered or after
/// `retry`, which doubles up to 3 s while no value arrives. It never ends by itself.
class ParameterList {
 public:
  struct Options {
    Time ask_period{std::chrono::seconds{1}};
    Time stall{std::chrono::milliseconds{250}};
    Time retry{std::chrono::milliseconds{200}};
    std::size_t window{16};
  };

  struct Counters {
    std::uint64_t list_requests{};
    std::uint64_t index_requests{};
  };

  /// @param table  receives the values and notes the requests; must outlive this.
  ParameterList(const Options& options, ParameterTable& table) : options_(options), table_(table) {}

  /// Requests the list from the beginning.
  void start(Time now);
  /// A value has been accepted into the table. @param newly_fresh  it filled a gap.
  void received(std::size_t index, bool newly_fresh, Time now);
  /// Sends due requests. Call it only while the link is open.
  void run(Port& port);

  /// Takes over how far another one is, but for the table.
  void copy_state_of(const ParameterList& other);

  bool active() const { return phase_ != Phase::kIdle; }
  Time next_due() const { return phase_ == Phase::kIdle ? kNever : due_; }
  const Counters& counters() const { return counters_; }

 private:
  enum class Phase : std::uint8_t { kIdle, kAsking, kFlowing, kFilling };

  void ask_for_missing(Port& port);

  Options options_;
  ParameterTable& table_;
  Phase phase_{Phase::kIdle};
  Time due_{kNever};
  Time retry_{};
  std::size_t waiting_for_{0};  ///< Answers of the batch still to come.
  std::size_t cursor_{0};
  bool progress_{false};
  Counters counters_;
};

}  // namespace rosflight::companion
