// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// YAML for people who make mistakes: every key must be known, present once, of the right type and
/// in range.
///
///     auto document = config::Document::from_file("vehicles/multirotor.yaml");
///     document.set("body.mass_kg=3.2");                        // --set of a command line
///     config::Section body = document.root().section("body");
///     const double mass_kg = body.number("mass_kg", config::Range::positive());
///     const double drag = body.number("drag", config::Range::at_least(0.0), 0.1);  // default
///     body.finish();                                           // unknown keys are errors
///
/// Every fault is a config::Error with one line:  FILE:LINE: KEY: found X, allowed Y
/// Units: values are plain SI numbers, the key carries the unit. Anchors and aliases work; tags,
/// merge keys, several documents, NaN and infinity do not.
namespace rosflight::config {

class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Allowed numbers. Bounds belong to the range unless `open`.
struct Range {
  double low{-std::numeric_limits<double>::infinity()};
  double high{std::numeric_limits<double>::infinity()};
  bool low_open{false};

  static constexpr Range any() { return {}; }
  static constexpr Range positive() { return {.low = 0.0, .low_open = true}; }
  static constexpr Range positive_up_to(double high) {
    return {.low = 0.0, .high = high, .low_open = true};
  }
  static constexpr Range at_least(double low) { return {.low = low}; }
  static constexpr Range between(double low, double high) { return {.low = low, .high = high}; }

  constexpr bool contains(double x) const { return (low_open ? x > low : x >= low) && x <= high; }
  /// "a number > 0", "a number from 0 to 1".
  std::string text() const;
};

namespace detail {
struct Node;
}

/// One map of a document. A cheap handle; keeps its document alive. Reading a key marks it as
/// known. All getters throw Error on a wrong type or a value outside the range, and, without a
/// default, if absent.
class Section {
 public:
  /// Whether the key is there; makes it known either way.
  bool has(std::string_view key) const;

  double number(std::string_view key, Range allowed) const;
  double number(std::string_view key, Range allowed, double if_absent) const;
  std::int64_t integer(std::string_view key, std::int64_t low, std::int64_t high) const;
  std::int64_t integer(std::string_view key, std::int64_t low, std::int64_t high,
                       std::int64_t if_absent) const;
  bool boolean(std::string_view key) const;
  bool boolean(std::string_view key, bool if_absent) const;
  std::string text(std::string_view key) const;
  std::string text(std::string_view key, std::string_view if_absent) const;

  /// A list of numbers, all within `allowed`; `count` must match unless it is kAnyCount.
  static constexpr std::size_t kAnyCount = std::numeric_limits<std::size_t>::max();
  std::vector<double> numbers(std::string_view key, std::size_t count, Range allowed) const;
  std::vector<double> numbers(std::string_view key, std::size_t count, Range allowed,
                              std::vector<double> if_absent) const;

  /// A list of lists of `columns` numbers each.
  std::vector<std::vector<double>> rows(std::string_view key, std::size_t columns,
                                        Range allowed) const;

  /// One of a few words.
  template <typename T>
  using Choices = std::vector<std::pair<std::string_view, T>>;
  template <typename T>
  T choice(std::string_view key, const Choices<T>& choices) const {
    return choices[choice_index(key, words(choices))].second;
  }
  template <typename T>
  T choice(std::string_view key, const Choices<T>& choices, T if_absent) const {
    return has(key) ? choice(key, choices) : if_absent;
  }

  /// A map inside this one; finish() looks into it. Absent: an error, or with `optional_section`
  /// nothing.
  Section section(std::string_view key) const;
  std::optional<Section> optional_section(std::string_view key) const;
  /// A map that another owner reads and finishes: finish() here does not look into it. Absent or
  /// empty: empty.
  Section foreign_section(std::string_view key) const;
  /// A list of maps.
  std::vector<Section> sections(std::string_view key) const;

  /// All keys, in order of the file. Marks none.
  std::vector<std::string> keys() const;

  /// Throws if a key of this section, or of a section opened by section() or sections(), was never
  /// asked for.
  void finish() const;

  /// An Error at `key` for checks between values: "... found FOUND, allowed ALLOWED".
  Error error(std::string_view key, const std::string& found, const std::string& allowed) const;
  /// The same about the section itself.
  Error error(const std::string& found, const std::string& allowed) const;
  /// Value at `key` as written, for messages; "nothing" if absent.
  std::string raw(std::string_view key) const;
  /// Directory of the file this came from, for files named relative to it; empty for text.
  std::filesystem::path directory() const;

 private:
  friend class Document;
  Section(std::shared_ptr<detail::Node> root, detail::Node* node)
      : root_{std::move(root)}, node_{node} {}

  template <typename T>
  static std::vector<std::string_view> words(const Choices<T>& choices) {
    std::vector<std::string_view> all;
    for (const auto& choice : choices) all.push_back(choice.first);
    return all;
  }
  std::size_t choice_index(std::string_view key,
                           const std::vector<std::string_view>& choices) const;
  /// Marks `key` as asked for.
  detail::Node* find(std::string_view key) const;
  const detail::Node& require(std::string_view key, const std::string& allowed) const;

  std::shared_ptr<detail::Node> root_;
  detail::Node* node_;
};

/// A whole file, in memory. Copies share it.
class Document {
 public:
  static constexpr std::size_t kMaxBytes = 4U << 20U;

  /// Reads a file. Throws Error if it cannot be read, is empty, binary, too long or not YAML.
  static Document from_file(const std::filesystem::path& file);
  /// `name` stands for the file in messages; `directory` for its place.
  static Document from_text(std::string_view text, std::string name,
                            const std::filesystem::path& directory = {});

  /// Applies "a.b.c=value" before reading: maps by key, lists by index from 0; the value is YAML
  /// ("[1, 2]"). New keys are added, so a misspelt one is reported by finish() like one in the
  /// file. Throws Error if the text is no assignment or steps into a scalar. `option` names its
  /// origin in messages.
  void set(std::string_view assignment, std::string_view option = "--set");

  /// Puts `over` on top: maps are merged key by key, everything else is replaced. Each value keeps
  /// the file and line it came from.
  void merge(const Document& over);
  /// Takes a top-level key away, if it is there. For keys that say how to read the file.
  void remove(std::string_view key);

  /// The top-level map; an Error if the file holds something else.
  Section root() const;
  /// The top-level list of maps.
  std::vector<Section> root_sections() const;
  bool is_list() const;

  /// The document with its overrides as YAML, without comments.
  std::string text() const;

 private:
  explicit Document(std::shared_ptr<detail::Node> root) : root_{std::move(root)} {}
  static Document rooted(std::unique_ptr<detail::Node> root);
  std::shared_ptr<detail::Node> root_;
};

/// A number as YAML writes it (-.99, 1e-3, 5.), the whole text; nothing for anything else, NaN and
/// infinity.
std::optional<double> parse_number(std::string_view text);
/// Shortest decimal text that reads back as x; without exponent from 1e-4 to 1e9.
std::string number_text(double x);

}  // namespace rosflight::config
