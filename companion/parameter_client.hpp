// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "companion/job.hpp"
#include "companion/parameter_list.hpp"
#include "companion/parameter_requests.hpp"
#include "companion/parameter_results.hpp"
#include "companion/parameter_table.hpp"
#include "companion/port.hpp"

namespace rosflight::companion {

/// Moves the choice of mixers behind the others: the firmware makes its mixers when they are chosen, and
/// checks them against the other parameters.
void put_mixers_last(ParameterSet& set);

/// The parameters of the FCU: a mirror of its table, and jobs that read, set, load and save.
class ParameterClient {
 public:
  struct Options {
    bool automatic_list{true};  ///< Request the list at each start of link or FCU.
    ParameterList::Options list;
    ParameterRequests::Options requests;
    Time list_timeout{
        std::chrono::seconds{30}};  ///< Max time of refresh() and save() without progress.
  };

  struct Counters {
    std::uint64_t values{};     ///< PARAM_VALUE messages that fit the table.
    std::uint64_t malformed{};  ///< Rejected: not a valid parameter.
    std::uint64_t foreign{};    ///< Rejected: belongs to another table.
  };

  struct ListResult {
    std::size_t received{};
    std::size_t count{};
  };

  /// A set that took effect can be overwritten by a later one of the same file (a mixer choice
  /// fills the matrix). If the first round set anything, the second therefore reads all again and
  /// sets what did not stay; if there was such, the third decides.
  static constexpr int kLoadRounds = 3;

  /// @param port  must outlive this.
  ParameterClient(const Options& options, Port& port);
  ~ParameterClient();
  ParameterClient(const ParameterClient&) = delete;
  ParameterClient& operator=(const ParameterClient&) = delete;

  // The mirror.
  const ParameterTable& table() const { return table_; }
  bool complete() const { return table_.complete(); }
  /// The last value received of a parameter; nothing if none was.
  std::optional<ParameterValue> get(std::string_view name) const;
  /// A value changed since the last successful write command or start of the FCU. BARO_BIAS and GROUND_LEVEL do not count: the
  /// firmware measures them at every start.
  bool unsaved() const { return changes_ != saved_changes_; }
  const Counters& counters() const { return counters_; }
  const ParameterList::Counters& list_counters() const { return list_.counters(); }

  // Jobs. Each ends with a result or a timeout.
  Job<ListResult> refresh();  ///< Reads the whole table again.
  /// Reads one parameter from the FCU.
  Job<ParameterResult> read(std::string_view name);
  /// Sets one parameter and confirms its value (ParameterRequests).
  Job<ParameterResult> set(std::string_view name, double value);
  /// Sets all values of a set. Done if every value is in force, failed if any is not; the report lists
  /// them all.
  Job<LoadReport> load(ParameterSet set);
  /// The same from a file, mixers last: the firmware checks a mixer against other parameters when it is chosen. A file with an
  /// error sets nothing and fails with the line of the error.
  Job<LoadReport> load_file(const std::filesystem::path& path);
  /// Writes all values, or only those that differ from `defaults` if given, as soon as the list is
  /// complete. The file appears whole or not at all.
  Job<ListResult> save_file(const std::filesystem::path& path, ParameterSet defaults = {});

  // For the session.
  void link_opened();          ///< Requests the list, if automatic.
  void connected(bool again);  ///< After a lost connection any value may have changed.
  void fcu_restarted();  ///< Stored values are in force: clears the mirror and reads it again.
  /// Requests the whole list.
  void start_list();
  /// Processes a value of the FCU.
  void received(const link::ParamValue& message);
  /// Sends due requests and ends overdue jobs.
  void run(bool link_open);
  /// The earliest time at which run() has something to do.
  Time next_due(bool link_open) const;
  std::uint64_t revision() const { return changes_; }
  /// A write command that was sent at `revision` succeeded.
  void written(std::uint64_t revision);
  /// A read command succeeded: the stored values are in force on the FCU, but not in the mirror.
  void reloaded_from_storage();
  /// Ends every job as failed, with a reason.
  void fail_all(const std::string& reason);
  /// The version for the head of saved files.
  /// No job is pending.
  bool idle() const {
    return requests_.idle() && refreshes_.empty() && saves_.empty() && loads_.empty();
  }
  /// Takes over the state of another one; both must be idle.
  void copy_state_of(const ParameterClient& other);
  void set_firmware_version(std::string_view text) { firmware_version_ = text; }

 private:
  struct Load {
    ParameterSet set;
    std::shared_ptr<JobRecord<LoadReport>> job;
    std::size_t open{0};
    int round{1};
    bool any_set{false};  ///< In this round.
  };
  struct Save {
    std::filesystem::path path;
    ParameterSet defaults;
    std::shared_ptr<JobRecord<ListResult>> job;
  };

  void list_complete();
  void write_save(const Save& save);
  void request_entry(const std::shared_ptr<Load>& load, std::size_t entry);
  void entry_ended(const std::shared_ptr<Load>& load, std::size_t entry,
                   const ParameterResult& result);
  void end_round(const std::shared_ptr<Load>& load);
  void publish_unsaved();

  Options options_;
  Port& port_;
  ParameterTable table_;
  ParameterList list_;
  ParameterRequests requests_;
  JobEnds ends_;
  std::vector<std::shared_ptr<JobRecord<ListResult>>> refreshes_;
  std::vector<Save> saves_;
  std::vector<std::shared_ptr<Load>> loads_;
  Time list_progress_{};
  std::uint64_t changes_{0};
  std::uint64_t saved_changes_{0};
  bool published_unsaved_{false};
  bool saved_when_listed_{false};
  int foreign_in_a_row_{0};
  std::string firmware_version_;
  Counters counters_;
};

}  // namespace rosflight::companion
