// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "companion/parameter_results.hpp"
#include "companion/parameter_table.hpp"
#include "companion/port.hpp"

namespace rosflight::companion {

/// Reads and sets single parameters, many at a time, each until the FCU has confirmed a value.
///
/// A set is believed when a PARAM_VALUE with the wanted value comes. The old value proves nothing
/// yet: it may have been on its way (list transfer), or the set was lost and only the question
/// after it arrived. So the set is repeated with a read behind it; when two old values answer that
/// pair (two pairs while a list is coming), the FCU has seen the set and refused. A third value
/// seen twice is the FCU's own choice: clamped. An FCU of ROSflight 2.x answers nothing to a set of
/// the value it has: a parameter that seems to have it is read instead. Requests are served in
/// order, `window` at a time, never two of the same name.
class ParameterRequests {
 public:
  struct Options {
    Time retry{std::chrono::milliseconds{200}};  ///< First time-out; grows by half each, up to 1 s.
    int attempts{8};         ///< While the FCU answers nothing at all: 5.6 s until "no answer".
    int attempts_alive{20};  ///< While it answers others. Enough for 1 % of the bytes lost.
    std::size_t window{16};
    Time closed_link_timeout{std::chrono::seconds{10}};
  };
  using Done = std::function<void(const ParameterResult&)>;

  ParameterRequests(const Options& options, const ParameterTable& table, Port& port)
      : options_(options), table_(table), port_(port) {}

  void read(std::string_view name, Done done);
  /// @param type  the type it must have on the FCU, if that matters.
  void set(std::string_view name, double wanted, std::optional<link::ParamType> type, Done done);

  /// A well-formed value has been accepted into the table.
  void received(const link::ParamName& name, const ParameterValue& value);
  /// Nothing is known of the table any more: whoever is on the way starts again.
  void table_forgotten();
  void run(bool link_open);
  Time next_due() const { return due_; }
  bool idle() const { return queue_.empty() && active_.empty(); }
  /// Ends all with "no answer" and `reason`.
  void abandon(const std::string& reason);

 private:
  struct Request {
    bool is_set{false};
    link::ParamName name{};
    double wanted{};
    std::optional<link::ParamType> required_type;
    Done done;
    ParameterResult result;
    bool resolved{false};  ///< `index` and, for a set, `target` are valid.
    std::size_t index{0};
    ParameterValue target{};
    ParameterValue before{};              ///< Value when the first set left; valid if sets > 0.
    std::optional<ParameterValue> other;  ///< Neither this nor the wanted one.
    int sets{0};
    int old_values{0};  ///< Answers with `before` since the last set.
    int old_pairs{0};   ///< Sets that were answered by two old values.
    int old_rounds{0};  ///< Sets that were answered by any.
    bool ended{false};
    int attempts{0};
    Time started{};
    Time retry{};
    Time retry_at{};
  };

  void enqueue(std::string_view name, Request request);
  void activate();
  bool resolve(Request& request);
  bool send_read(const Request& request);
  bool transmit(Request& request);
  void answered(Request& request, const ParameterValue& value);
  void refused(Request& request);
  void contradicted(Request& request, const ParameterValue& value);
  void end(Request& request, ParameterOutcome outcome, const std::string& reason);
  void sweep();
  void reschedule();

  Options options_;
  const ParameterTable& table_;
  Port& port_;
  std::deque<Request> queue_;
  std::vector<Request> active_;
  std::optional<Time> last_answer_;
  std::optional<Time> closed_since_;
  Time due_{kNever};
};

}  // namespace rosflight::companion
