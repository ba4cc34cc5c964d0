// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <concepts>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/constants.hpp"
#include "config/strict_yaml.hpp"

/// One row per parameter. A table of rows reads a section of a YAML file into a struct, checks it,
/// writes it, and documents it; ROS nodes declare their parameters from the same rows.
///
///     config::Table<Landing> landing_table() {
///       using L = Landing;
///       return {{"speed_m_s", &L::speed_m_s, "m/s", Range::between(0.1, 20.0), "of the descent"},
///               {"tilt_deg", &L::max_tilt_rad, kDeg, Range::between(1.0, 60.0), "largest tilt"}};
///     }
///
/// The default of a parameter is what its member holds before reading. Host only.
namespace rosflight::config {

/// Unit of a key as text, and what the member holds for a value of 1.
struct Unit {
  // NOLINTNEXTLINE(google-explicit-constructor): a row names its unit as a text
  constexpr Unit(const char* name, double in_member = 1.0) : text{name}, factor{in_member} {}
  constexpr explicit Unit(std::string_view name) : text{name}, factor{1.0} {}
  std::string_view text;
  double factor;
};
inline constexpr Unit kDeg{"deg", base::kRadPerDeg};
inline constexpr Unit kDegPerS{"deg/s", base::kRadPerDeg};
inline constexpr Unit kDegPerS2{"deg/s^2", base::kRadPerDeg};

/// Limits of an integer.
struct Whole {
  std::int64_t low, high;
};

/// Says that a row is a list of points.
struct Points {};

namespace detail {

using Values = std::vector<double>;

/// A row of any struct: values are numbers in the unit of the key, whatever the member is. A
/// boolean is 0 or 1, a choice the index of its word, an absent optional value no number.
struct Row {
  enum class Kind { kNumber, kNumbers, kPoints, kInteger, kBoolean, kChoice, kSection, kList };

  std::string key;     ///< A section may have "": its rows stand among those around it.
  std::string former;  ///< Spelling of earlier versions, still accepted.
  Kind kind{};
  std::string_view unit;
  double factor{1.0};  ///< What the member holds for a value of 1.
  Range allowed;
  std::string_view text;
  bool needed{false};
  std::size_t count{1};                 ///< Numbers in a kNumbers (or kAnyCount), or in one point.
  Whole items{};                        ///< Bounds of the number of items of a kList.
  std::vector<std::string_view> words;  ///< Words of a kChoice.
  std::string default_text;             ///< Says where a derived default comes from.
  std::string allowed_text;             ///< Where `allowed` alone does not tell.
  std::function<Values(const void*)> get;
  std::function<void(void*, const Values&)> set;
  std::function<void(void*)> derive;           ///< Sets the default from rows above.
  std::function<bool(const void*)> needed_if;  ///< Needed where this holds, from rows above.
  std::function<Range(const void*)> limits;    ///< Instead of `allowed`, from rows above.
  std::function<bool(double)> accepts;         ///< Besides the range.
  std::function<bool(const void*)> holds;      ///< After all rows of the section.
  std::string holds_text;

  std::function<void*(void*)> at;     ///< kSection: the struct inside; null: absent.
  std::function<void*(void*)> renew;  ///< If set: a section that is there begins from zero.
  std::function<void*(void*)> add;    ///< kList: a new struct at its end.
  std::function<std::vector<void*>(void*)> all;  ///< kList: its structs.
  std::vector<Row> rows;
};

void read(const Section& in, const std::vector<Row>& rows, void* s);
std::string write(const std::vector<Row>& rows, const void* s, bool commented, int depth);
std::string page(const std::vector<Row>& rows, const void* s);
/// The rows of all sections with their whole path as key and getters from the outermost struct.
std::vector<Row> flatten(const std::vector<Row>& rows);

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {
  using Value = T;
};

}  // namespace detail

/// The member of a member of a struct.
template <class T, class S>
auto at(T S::*member) {
  return [member](S& s) -> T& { return s.*member; };
}
template <class T, class S, class... More>
auto at(T S::*member, More... more) {
  return [member, rest = at(more...)](S& s) -> auto& { return rest(s.*member); };
}

template <class S>
class Table;

/// One row of the table of S. `member` is a member pointer, at(...), or a function from S& to the
/// member's reference.
template <class S>
class Row {
 public:
  template <class M>
  using MemberOf = std::remove_cvref_t<std::invoke_result_t<const M&, S&>>;

  /// A number, an optional number, or a list of numbers: fixed (std::array, Eigen vector) or of any
  /// length (std::vector).
  template <class M>
  Row(std::string_view key, M member, Unit unit, Range allowed, std::string_view text)
      : Row{key, text, detail::Row::Kind::kNumber} {
    using T = MemberOf<M>;
    row_.unit = unit.text;
    row_.factor = unit.factor;
    row_.allowed = allowed;
    if constexpr (std::same_as<T, double>) {
      bind(
          member, [f = unit.factor](double v) { return detail::Values{v / f}; },
          [f = unit.factor](double& v, const detail::Values& x) { v = x[0] * f; });
    } else if constexpr (detail::IsOptional<T>::value) {
      bind(
          member,
          [f = unit.factor](const T& v) { return v ? detail::Values{*v / f} : detail::Values{}; },
          [f = unit.factor](T& v, const detail::Values& x) { v = x[0] * f; });
    } else if constexpr (std::same_as<T, detail::Values>) {
      row_.kind = detail::Row::Kind::kNumbers;
      row_.count = Section::kAnyCount;
      bind(member, [](const T& v) { return v; }, [](T& v, const detail::Values& x) { v = x; });
    } else {
      row_.kind = detail::Row::Kind::kNumbers;
      row_.count = static_cast<std::size_t>(T{}.size());
      bind(
          member, [](const T& v) { return detail::Values(v.data(), v.data() + v.size()); },
          [](T& v, const detail::Values& x) { std::copy(x.begin(), x.end(), v.data()); });
    }
  }

  /// A number with a law of its own between key and struct.
  template <std::invocable<const S&> Get, std::invocable<S&, double> Set>
  Row(std::string_view key, Get get, Set set, Unit unit, Range allowed, std::string_view text)
      : Row{key, text, detail::Row::Kind::kNumber} {
    row_.unit = unit.text;
    row_.allowed = allowed;
    row_.get = [get](const void* s) { return detail::Values{get(*static_cast<const S*>(s))}; };
    row_.set = [set](void* s, const detail::Values& x) { set(*static_cast<S*>(s), x[0]); };
  }

  /// A fixed list of numbers with a law of its own between key and struct.
  template <std::invocable<const S&> Get, std::invocable<S&, const std::vector<double>&> Set>
  Row(std::string_view key, std::size_t count, Get get, Set set, Unit unit, Range allowed,
      std::string_view text)
      : Row{key, text, detail::Row::Kind::kNumbers} {
    row_.unit = unit.text;
    row_.allowed = allowed;
    row_.count = count;
    row_.get = [get](const void* s) { return get(*static_cast<const S*>(s)); };
    row_.set = [set](void* s, const detail::Values& x) { set(*static_cast<S*>(s), x); };
  }

  /// A list of points, each of three numbers: all of them one after the other.
  template <std::invocable<const S&> Get, std::invocable<S&, const std::vector<double>&> Set>
  Row(std::string_view key, Points /*kind*/, Get get, Set set, Unit unit, Range allowed,
      std::string_view text)
      : Row{key, 3, get, set, unit, allowed, text} {
    row_.kind = detail::Row::Kind::kPoints;
  }

  /// true or false.
  template <class M>
    requires std::same_as<MemberOf<M>, bool>
  Row(std::string_view key, M member, std::string_view text)
      : Row{key, text, detail::Row::Kind::kBoolean} {
    bind(
        member, [](bool v) { return detail::Values{v ? 1.0 : 0.0}; },
        [](bool& v, const detail::Values& x) { v = x[0] != 0.0; });
  }

  /// true or false, with a law of its own between key and struct.
  template <std::invocable<const S&> Get, std::invocable<S&, bool> Set>
    requires std::same_as<std::invoke_result_t<Get, const S&>, bool>
  Row(std::string_view key, Get get, Set set, std::string_view text)
      : Row{key, text, detail::Row::Kind::kBoolean} {
    row_.get = [get](const void* s) {
      return detail::Values{get(*static_cast<const S*>(s)) ? 1.0 : 0.0};
    };
    row_.set = [set](void* s, const detail::Values& x) { set(*static_cast<S*>(s), x[0] != 0.0); };
  }

  /// An integer. Of a duration: its count.
  template <class M>
  Row(std::string_view key, M member, Unit unit, Whole allowed, std::string_view text)
      : Row{key, text, detail::Row::Kind::kInteger} {
    using T = MemberOf<M>;
    row_.unit = unit.text;
    row_.allowed =
        Range::between(static_cast<double>(allowed.low), static_cast<double>(allowed.high));
    const auto number = [](const T& v) {
      if constexpr (requires { v.count(); }) {
        return detail::Values{static_cast<double>(v.count())};
      } else {
        return detail::Values{static_cast<double>(v)};
      }
    };
    bind(member, number, [](T& v, const detail::Values& x) {
      if constexpr (requires { v.count(); }) {
        v = T{static_cast<std::int64_t>(x[0])};
      } else {
        v = static_cast<T>(x[0]);
      }
    });
  }

  /// One of a few words.
  template <class M>
    requires(std::is_enum_v<MemberOf<M>> || std::same_as<MemberOf<M>, bool>)
  Row(std::string_view key, M member, const Section::Choices<MemberOf<M>>& choices,
      std::string_view text)
      : Row{key, text, detail::Row::Kind::kChoice} {
    using T = MemberOf<M>;
    for (const auto& choice : choices) row_.words.push_back(choice.first);
    bind(
        member,
        [choices](T v) {
          double i = 0.0;
          for (const auto& choice : choices) {
            if (choice.second == v) break;
            i += 1.0;
          }
          return detail::Values{i};
        },
        [choices](T& v, const detail::Values& x) {
          v = choices[static_cast<std::size_t>(x[0])].second;
        });
  }

  /// A section with the rows of a struct inside S; an optional one is there if its section is.
  template <class M, class T>
    requires(std::same_as<MemberOf<M>, T> || std::same_as<MemberOf<M>, std::optional<T>>)
  Row(std::string_view key, M member, const Table<T>& table, std::string_view text = {})
      : Row{key, text, detail::Row::Kind::kSection} {
    row_.rows = table.rows();
    row_.at = [member](void* s) -> void* {
      auto& inside = std::invoke(member, *static_cast<S*>(s));
      if constexpr (std::same_as<MemberOf<M>, T>) {
        return &inside;
      } else {
        return inside ? &*inside : nullptr;
      }
    };
    if constexpr (!std::same_as<MemberOf<M>, T>) {
      row_.renew = [member](void* s) -> void* {
        return &std::invoke(member, *static_cast<S*>(s)).emplace();
      };
    } else if (table.is_whole()) {
      row_.renew = [member](void* s) -> void* {
        return &(std::invoke(member, *static_cast<S*>(s)) = T{});
      };
    }
  }

  /// A list of sections, each with the rows of a struct.
  template <class M, class T>
    requires std::same_as<MemberOf<M>, std::vector<T>>
  Row(std::string_view key, M member, const Table<T>& table, Whole items, std::string_view text)
      : Row{key, text, detail::Row::Kind::kList} {
    row_.rows = table.rows();
    row_.items = items;
    row_.needed = items.low > 0;
    row_.add = [member](void* s) -> void* {
      return &std::invoke(member, *static_cast<S*>(s)).emplace_back();
    };
    row_.all = [member](void* s) {
      std::vector<void*> all;
      for (T& item : std::invoke(member, *static_cast<S*>(s))) all.push_back(&item);
      return all;
    };
  }

  /// The key must be there.
  Row needed() && {
    row_.needed = true;
    return std::move(*this);
  }
  /// The key must be there where rows above say so; `when` is "with the model cells".
  Row needed_if(const std::string& when, std::function<bool(const S&)> holds) && {
    row_.default_text = "needed " + when;
    row_.needed_if = [holds](const void* s) { return holds(*static_cast<const S*>(s)); };
    return std::move(*this);
  }
  /// A spelling of earlier versions, still accepted.
  Row formerly(std::string_view key) && {
    row_.former = key;
    return std::move(*this);
  }
  /// The default depends on rows above.
  Row derived(std::string_view law, std::function<void(S&)> derive) && {
    row_.default_text = law;
    row_.derive = [derive = std::move(derive)](void* s) { derive(*static_cast<S*>(s)); };
    return std::move(*this);
  }
  /// What an absent optional value means.
  Row if_absent(std::string_view text) && {
    row_.default_text = text;
    return std::move(*this);
  }
  /// The range depends on rows above.
  Row within(std::string_view text, std::function<Range(const S&)> limits) && {
    row_.allowed_text = text;
    row_.limits = [limits = std::move(limits)](const void* s) {
      return limits(*static_cast<const S*>(s));
    };
    return std::move(*this);
  }
  /// Values of the range that are allowed; `text` says which in the error.
  Row only(std::string_view text, std::function<bool(double)> accepts) && {
    row_.allowed_text = text;
    row_.accepts = std::move(accepts);
    return std::move(*this);
  }
  /// A condition on the whole struct, checked after the rows of its section.
  Row must(std::string_view text, std::function<bool(const S&)> holds) && {
    row_.holds_text = text;
    row_.holds = [holds = std::move(holds)](const void* s) {
      return holds(*static_cast<const S*>(s));
    };
    return std::move(*this);
  }

  const detail::Row& untyped() const { return row_; }

 private:
  Row(std::string_view key, std::string_view text, detail::Row::Kind kind) {
    row_.key = key;
    row_.text = text;
    row_.kind = kind;
  }

  template <class M, class Get, class Set>
  void bind(M member, Get get, Set set) {
    row_.get = [member, get = std::move(get)](const void* s) {
      return get(std::invoke(member, *const_cast<S*>(static_cast<const S*>(s))));
    };
    row_.set = [member, set = std::move(set)](void* s, const detail::Values& x) {
      set(std::invoke(member, *static_cast<S*>(s)), x);
    };
  }

  detail::Row row_;
};

/// A parameter of a table on its own, for code that sets single ones.
template <class S>
struct Parameter {
  detail::Row row;  ///< `key` is the whole path, such as "limits.tilt_deg".

  detail::Values get(const S& s) const { return row.get(&s); }
  void set(S& s, const detail::Values& values) const { row.set(&s, values); }
};

/// The parameters of a struct, in the order in which they are read.
template <class S>
class Table {
 public:
  Table(std::initializer_list<Row<S>> rows) {
    for (const Row<S>& row : rows) rows_.push_back(row.untyped());
  }
  explicit Table(const std::vector<Row<S>>& rows) {
    for (const Row<S>& row : rows) rows_.push_back(row.untyped());
  }
  /// A section that is there begins from S{}, not from what the struct held: for gains, of which
  /// those that are left out are 0.
  Table whole() && {
    whole_ = true;
    return std::move(*this);
  }

  /// Reads what is there; the rest stays as it is, or as derived from what was read. Does not
  /// finish the section. Throws Error.
  void read(const Section& in, S& s) const { detail::read(in, rows_, &s); }

  /// All keys with the values of `s`, as YAML that reads back to them.
  std::string write(const S& s) const { return detail::write(rows_, &s, false, 0); }
  /// The same with unit, range and meaning as comments; derived and absent values are comments too,
  /// so that they stay derived. `depth`: sections around this one.
  std::string commented(const S& s, int depth = 0) const {
    return detail::write(rows_, &s, true, depth);
  }
  /// A page in Markdown: key, default, unit, allowed, meaning; a heading for each section.
  std::string page(const S& defaults) const { return detail::page(rows_, &defaults); }

  /// All parameters of all sections.
  std::vector<Parameter<S>> parameters() const {
    std::vector<Parameter<S>> all;
    for (detail::Row& row : detail::flatten(rows_)) all.push_back({std::move(row)});
    return all;
  }

  const std::vector<detail::Row>& rows() const { return rows_; }
  bool is_whole() const { return whole_; }

 private:
  std::vector<detail::Row> rows_;
  bool whole_{false};
};

}  // namespace rosflight::config
