// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string_view>
#include <vector>

#include "companion/parameter.hpp"
#include "link/messages.hpp"

namespace rosflight::companion {

/// The part of the FCU's parameter table that was received. The index identifies an entry; name and
/// type belong to it.
///
/// The first count sets the size. A PARAM_VALUE that does not fit (other count, index past the end,
/// other name or type than before at that index, a name at another index) is foreign and changes
/// nothing.
class ParameterTable {
 public:
  enum class Update : std::uint8_t {
    kMalformed,  ///< No valid parameter: count 0, bad type, bad name, index >= count.
    kForeign,    ///< Belongs to another table.
    kNew,        ///< First value of this index.
    kSame,
    kChanged
  };

  struct Entry {
    link::ParamName name{};
    ParameterValue value{};
    bool known{false};  ///< Received at least once.
    bool fresh{false};  ///< Received since the last forget() or age().
    /// Answers that may still be on their way, with the value of their time: reads less values received since.
    std::uint32_t awaited{0};
  };

  struct Result {
    Update update{};
    ParameterValue old_value{};  ///< With kChanged.
  };

  /// Processes a message of the FCU.
  Result accept(const link::ParamValue& message);

  /// A read of this index was sent.
  void note_read(std::size_t index) { ++entries_[index].awaited; }

  void forget();  ///< Clears the table: another FCU, or a restart.
  void age();     ///< Marks all values as not fresh.

  std::size_t count() const { return entries_.size(); }  ///< 0 until the first value.
  std::size_t known() const { return known_; }
  std::size_t fresh() const { return fresh_; }
  bool complete() const { return !entries_.empty() && known_ == entries_.size(); }
  bool all_fresh() const { return !entries_.empty() && fresh_ == entries_.size(); }

  const Entry& operator[](std::size_t index) const { return entries_[index]; }
  /// Index of a known entry.
  std::optional<std::size_t> find(std::string_view name) const;
  std::optional<std::size_t> find(const link::ParamName& name) const;
  /// First index at or after `from` that is not fresh.
  std::optional<std::size_t> next_missing(std::size_t from) const;

  /// All known values, sorted by name.
  ParameterSet values() const;

 private:
  std::vector<Entry> entries_;
  std::size_t known_{0};
  std::size_t fresh_{0};
};

}  // namespace rosflight::companion
