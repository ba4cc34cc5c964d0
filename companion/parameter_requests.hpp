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

/// Reads and sets single parameters, several at a time, each until the FCU has confirmed a value.
///
/// A set is confirmed by a PARAM_VALUE with the requested value. The old value is no refusal yet: it
/// may have been sent before (list transfer), or the set was lost and only the read after it
/// arrived. The set is therefore repeated with a read behind it; when two old values answer that
/// pair (two pairs during a list transfer), the FCU has refused the set. Answers to earlier reads, which a
/// busy FCU gives all at once, do not count. A third value received
/// twice was chosen by the FCU: clamped. An FCU of ROSflight 2.x does not answer a set of the value
/// it has, so a parameter that seems to have it is read instead. Requests are served in order,
/// `window` at a time, never two of the same name.
class ParameterRequests {
 public:
  struct Options {
    Time retry{std::chrono::milliseconds{200}};  ///< First timeout; grows by half each, up to 1 s.
    int attempts{8};             ///< Without any answer of the FCU: 5.6 s until "no answer".
    int attempts_connected{20};  ///< While it answers others. Enough for 1 % of the bytes lost.
    std::size_t window{16};
    Time closed_link_timeout{std::chrono::seconds{10}};
  };
  using Done = std::function<void(const ParameterResult&)>;

  /// @param table  the mirror of the FCU's table. @param port  both must outlive this.
  ParameterRequests(const Options& options, ParameterTable& table, Port& port)
      : options_(options), table_(table), port_(port) {}

  /// Reads a parameter; `done` receives the result.
  void read(std::string_view name, Done done);
  /// Sets a parameter; `done` receives the result.
  /// @param type  the type it must have on the FCU, if that matters.
  void set(std::string_view name, double wanted, std::optional<link::ParamType> type, Done done);

  /// A well-formed value has been accepted into the table.
  void received(const link::ParamName& name, const ParameterValue& value);
  /// The table was cleared: active requests start again.
  void table_forgotten();
  /// Sends due requests and ends those without an answer.
  void run(bool link_open);
  Time next_due() const { return due_; }
  /// Takes over the state of another one; both must be idle.
  void copy_state_of(const ParameterRequests& other);
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
    std::uint32_t late{0};  ///< Answers to reads before the last set that may still arrive.
    int old_values{0};      ///< Further answers with `before` since the last set.
    int old_pairs{0};       ///< Sets that were answered by two old values.
    int old_rounds{0};      ///< Sets that were answered by any.
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
  ParameterTable& table_;
  Port& port_;
  std::deque<Request> queue_;
  std::vector<Request> active_;
  std::optional<Time> last_answer_;
  std::optional<Time> closed_since_;
  Time due_{kNever};
};

}  // namespace rosflight::companion
