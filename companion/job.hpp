// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "companion/time.hpp"

namespace rosflight::companion {

enum class JobState : std::uint8_t { kPending, kDone, kFailed };

/// The shared state of a job, written by the client that does the work.
struct JobRecordBase {
  JobState state{JobState::kPending};
  std::string text;  ///< One line: the progress, and at the end the outcome.
  Time started{};
  Time finished{};
  std::vector<std::function<void()>> callbacks;
};

template <class Result>
struct JobRecord : JobRecordBase {
  Result result{};
};

/// Handle of a task that ends with a result or a timeout. Copies refer to the same job; a handle may
/// outlive the session. A default-constructed handle is a failed job.
template <class Result>
class Job {
 public:
  Job() : record_(refused()) {}
  /// @param record  the state that the client writes.
  explicit Job(std::shared_ptr<JobRecord<Result>> record) : record_(std::move(record)) {}

  JobState state() const { return record_->state; }
  bool pending() const { return record_->state == JobState::kPending; }
  bool done() const { return record_->state == JobState::kDone; }
  bool failed() const { return record_->state == JobState::kFailed; }
  const std::string& text() const { return record_->text; }
  /// Valid when not pending.
  const Result& result() const { return record_->result; }
  Time duration() const { return pending() ? Time{} : record_->finished - record_->started; }

  /// Calls `callback` once from inside the step that ends the job; at once if it has ended already.
  void when_finished(std::function<void()> callback) {
    if (pending()) {
      record_->callbacks.push_back(std::move(callback));
    } else {
      callback();
    }
  }

 private:
  static std::shared_ptr<JobRecord<Result>> refused() {
    auto record = std::make_shared<JobRecord<Result>>();
    record->state = JobState::kFailed;
    record->text = "never started";
    return record;
  }
  std::shared_ptr<JobRecord<Result>> record_;
};

/// Ends jobs; callbacks run in flush(), when the client's own lists are in order again.
class JobEnds {
 public:
  JobEnds() = default;
  JobEnds(const JobEnds&) = delete;
  JobEnds& operator=(const JobEnds&) = delete;
  /// Callbacks not yet called are dropped: they often hold the job that holds them.
  ~JobEnds() {
    for (const auto& record : ended_) {
      record->callbacks.clear();
    }
  }

  /// Ends a job; its callbacks run in flush().
  void finish(const std::shared_ptr<JobRecordBase>& record, JobState state, std::string text,
              Time now) {
    record->state = state;
    record->text = std::move(text);
    record->finished = now;
    if (!record->callbacks.empty()) {
      ended_.push_back(record);
    }
  }

  /// Calls the callbacks of ended jobs, also of those that end meanwhile.
  void flush() {
    while (!ended_.empty()) {
      const auto batch = std::exchange(ended_, {});
      for (const auto& record : batch) {
        for (const auto& callback : std::exchange(record->callbacks, {})) {
          callback();
        }
      }
    }
  }

 private:
  std::vector<std::shared_ptr<JobRecordBase>> ended_;
};

}  // namespace rosflight::companion
