// SPDX-License-Identifier: BSD-3-Clause
#include "config/table.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace rosflight::config::detail {
namespace {

using Kind = Row::Kind;

/// The spelling of the key that is there. Where a file is extended or overridden in the other
/// spelling both are; then the later one counts.
const std::string& spelling(const Section& in, const Row& row) {
  if (row.former.empty()) return row.key;
  for (const std::string& key : in.keys()) {
    if (key == row.former) static_cast<void>(in.has(key));  // known
  }
  const std::vector<std::string> keys = in.keys();
  const auto latest = std::find_if(keys.rbegin(), keys.rend(), [&row](const std::string& key) {
    return key == row.key || key == row.former;
  });
  const bool is_former = latest != keys.rend() && *latest == row.former;
  if (is_former) static_cast<void>(in.has(row.key));
  return is_former ? row.former : row.key;
}

Values read_values(const Section& in, const std::string& key, const Row& row, Range allowed) {
  switch (row.kind) {
    case Kind::kNumbers:
      return in.numbers(key, row.count, allowed);
    case Kind::kPoints: {
      Values all;
      for (const Values& point : in.rows(key, row.count, allowed))
        all.insert(all.end(), point.begin(), point.end());
      return all;
    }
    case Kind::kInteger:
      return {static_cast<double>(in.integer(key, static_cast<std::int64_t>(allowed.low),
                                             static_cast<std::int64_t>(allowed.high)))};
    case Kind::kBoolean:
      return {in.boolean(key) ? 1.0 : 0.0};
    case Kind::kChoice: {
      Section::Choices<double> choices;
      for (const std::string_view word : row.words)
        choices.emplace_back(word, static_cast<double>(choices.size()));
      return {in.choice(key, choices)};
    }
    default:
      break;
  }
  const double value = in.number(key, allowed);
  if (row.accepts && !row.accepts(value)) throw in.error(key, in.raw(key), row.allowed_text);
  return {value};
}

void read_section(const Section& in, const Row& row, void* s) {
  if (row.key.empty()) {
    read(in, row.rows, row.at(s));
    return;
  }
  const auto section = row.needed ? in.section(row.key) : in.optional_section(row.key);
  if (section) {
    read(*section, row.rows, row.renew ? row.renew(s) : row.at(s));
  } else if (!row.renew) {
    // Absent is empty: derived defaults and conditions hold all the same.
    read(Document::from_text("{}", "defaults").root(), row.rows, row.at(s));
  }
}

void read_list(const Section& in, const Row& row, void* s) {
  if (!in.has(row.key) && !row.needed) return;
  const std::vector<Section> list = in.sections(row.key);
  const auto count = static_cast<std::int64_t>(list.size());
  if (count < row.items.low || count > row.items.high) {
    throw in.error(row.key, std::to_string(count) + " entries",
                   std::to_string(row.items.low) + " to " + std::to_string(row.items.high));
  }
  for (const Section& entry : list) read(entry, row.rows, row.add(s));
}

bool is_needed(const Row& row, const void* s) {
  return row.needed || (row.needed_if && row.needed_if(s));
}

/// Six digits: enough to recognise a number.
std::string rounded(double x) {
  std::array<char, 32> buffer{};
  const int length = std::snprintf(buffer.data(), buffer.size(), "%.6g", x);
  return {buffer.data(), static_cast<std::size_t>(length)};
}

/// As few digits as give the member the same bits.
std::string exact(const Row& row, double x) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.14g", x);
  const double shorter = std::strtod(buffer.data(), nullptr);
  return number_text(shorter * row.factor == x * row.factor ? shorter : x);
}

std::string value_text(const Row& row, const Values& values, bool whole_precision) {
  if (values.empty()) return "";
  if (row.kind == Kind::kBoolean) return values[0] != 0.0 ? "true" : "false";
  if (row.kind == Kind::kChoice) return std::string(row.words[static_cast<std::size_t>(values[0])]);
  const auto number = [&](double x) { return whole_precision ? exact(row, x) : rounded(x); };
  if (row.kind != Kind::kNumbers && row.kind != Kind::kPoints) return number(values[0]);
  std::string out;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool next = row.kind == Kind::kPoints && i % row.count == 0;
    out += i == 0 ? "" : next ? "], [" : ", ";
    out += number(values[i]);
  }
  return row.kind == Kind::kPoints ? "[[" + out + "]]" : "[" + out + "]";
}

std::string allowed_text(const Row& row) {
  if (!row.allowed_text.empty()) return row.allowed_text;
  if (row.kind == Kind::kBoolean) return "true, false";
  if (row.kind == Kind::kChoice) {
    std::string out;
    for (const std::string_view word : row.words)
      out += (out.empty() ? "" : ", ") + std::string(word);
    return out;
  }
  constexpr std::string_view kNumber = "a number";
  std::string range = row.allowed.text().substr(kNumber.size());
  if (!range.empty()) range.erase(0, 1);
  if (range.empty()) range = "any number";
  if (row.kind == Kind::kInteger) range += ", whole";
  if (row.kind == Kind::kNumbers && row.count == Section::kAnyCount)
    range = "numbers, each " + range;
  else if (row.kind == Kind::kNumbers)
    range = std::to_string(row.count) + " numbers, each " + range;
  if (row.kind == Kind::kPoints)
    range = "lists of " + std::to_string(row.count) + " numbers, each " + range;
  return range;
}

/// "from 1 to 60 deg: of every commanded attitude".
std::string comment(const Row& row) {
  std::string out = allowed_text(row);
  if (!row.unit.empty()) out += " " + std::string(row.unit);
  if (!row.holds_text.empty()) out += "; " + row.holds_text;
  if (!row.text.empty()) out += ": " + std::string(row.text);
  return out;
}

void write_rows(const std::vector<Row>& rows, void* s, bool commented, int depth, std::string& out);

void write_section(const Row& row, void* s, bool commented, int depth, bool again,
                   std::string& out) {
  void* inside = row.at(s);
  if (inside == nullptr) return;
  const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
  if (!row.key.empty() && !again) {
    if (commented && depth < 2) out += '\n';
    if (commented && !row.text.empty()) out += indent + "# " + std::string(row.text) + "\n";
    out += indent + row.key + ":\n";
  }
  write_rows(row.rows, inside, commented, row.key.empty() ? depth : depth + 1, out);
}

void write_list(const Row& row, void* s, bool commented, int depth, std::string& out) {
  const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
  const std::vector<void*> entries = row.all(s);
  out += indent + row.key + (entries.empty() ? ": []\n" : ":\n");
  for (void* entry : entries) {
    out += indent + "  -\n";
    write_rows(row.rows, entry, commented, depth + 2, out);
  }
}

void write_rows(const std::vector<Row>& rows, void* s, bool commented, int depth,
                std::string& out) {
  const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
  std::string last;
  for (const Row& row : rows) {
    if (row.kind == Kind::kList) {
      write_list(row, s, commented, depth, out);
      continue;
    }
    if (row.kind == Kind::kSection) {
      write_section(row, s, commented, depth, row.key == last, out);
      last = row.key;
      continue;
    }
    const std::string value = value_text(row, row.get(s), true);
    if (commented) out.append(indent).append("# ").append(comment(row)).append("\n");
    if (commented && !row.default_text.empty()) {
      out.append(indent).append("# ").append(row.key).append(": ");
      out.append(row.default_text).append("\n");
    } else if (!value.empty()) {
      out.append(indent).append(row.key).append(": ").append(value).append("\n");
    }
  }
}

/// Rows of the table in the page; those of sections inside with their path.
void page_rows(const std::vector<Row>& rows, void* s, bool whole, const std::string& prefix,
               std::string& out) {
  for (const Row& row : rows) {
    const std::string key = prefix + row.key;
    if (row.kind == Kind::kSection) {
      void* inside = s == nullptr ? nullptr : row.at(s);
      if (!row.text.empty()) out += "| `" + key + "` |  |  |  | " + std::string(row.text) + " |\n";
      page_rows(row.rows, inside, row.renew != nullptr, row.key.empty() ? prefix : key + ".", out);
      continue;
    }
    if (row.kind == Kind::kList) {
      out.append("| `" + key + "` | needed |  | " + std::to_string(row.items.low) + " to ");
      out.append(std::to_string(row.items.high) + " entries | " + std::string(row.text) + " |\n");
      page_rows(row.rows, nullptr, false, key + "[].", out);
      continue;
    }
    std::string value = row.default_text;
    if (value.empty()) {
      const bool none = s == nullptr || (row.needed && !whole);
      value = none ? (row.needed ? "needed" : "") : value_text(row, row.get(s), false);
    }
    std::string text(row.text);
    if (!row.holds_text.empty()) text += (text.empty() ? "" : "; ") + row.holds_text;
    if (!row.former.empty()) text.append("; former spelling `").append(row.former).append("`");
    out.append("| `").append(key).append("` | ").append(value).append(" | ").append(row.unit);
    out.append(" | ").append(allowed_text(row)).append(" | ").append(text).append(" |\n");
  }
}

void flatten_into(const std::vector<Row>& rows, const std::string& prefix,
                  const std::function<void*(void*, bool)>& at, std::vector<Row>& out) {
  for (const Row& row : rows) {
    Row flat = row;
    flat.key = prefix + row.key;
    if (row.kind == Kind::kSection) {
      const auto inside = [at, row_at = row.at, renew = row.renew](void* s, bool make) -> void* {
        void* outer = at(s, make);
        if (outer == nullptr) return nullptr;
        void* found = row_at(outer);
        return found == nullptr && make ? renew(outer) : found;
      };
      flatten_into(row.rows, row.key.empty() ? prefix : flat.key + ".", inside, out);
      continue;
    }
    if (row.kind == Kind::kList) continue;  // entries are no single parameters
    flat.get = [at, get = row.get](const void* s) {
      const void* inside = at(const_cast<void*>(s), false);
      return inside == nullptr ? Values{} : get(inside);
    };
    flat.set = [at, set = row.set](void* s, const Values& values) { set(at(s, true), values); };
    out.push_back(std::move(flat));
  }
}

}  // namespace

void read(const Section& in, const std::vector<Row>& rows, void* s) {
  for (const Row& row : rows) {
    if (row.kind == Kind::kSection) {
      read_section(in, row, s);
      continue;
    }
    if (row.kind == Kind::kList) {
      read_list(in, row, s);
      continue;
    }
    if (row.derive) row.derive(s);
    const std::string& key = spelling(in, row);
    if (!in.has(key) && !is_needed(row, s)) continue;
    row.set(s, read_values(in, key, row, row.limits ? row.limits(s) : row.allowed));
  }
  for (const Row& row : rows) {
    if (!row.holds || row.holds(s)) continue;
    const bool is_list = row.kind == Kind::kNumbers || row.kind == Kind::kPoints;
    const std::string found = is_list ? value_text(row, row.get(s), false) : in.raw(row.key);
    throw in.error(row.key, found.empty() ? "an empty list" : found, row.holds_text);
  }
}

std::string write(const std::vector<Row>& rows, const void* s, bool commented, int depth) {
  std::string out;
  write_rows(rows, const_cast<void*>(s), commented, depth, out);
  return out;
}

std::string page(const std::vector<Row>& rows, const void* s) {
  constexpr std::string_view kHead =
      "\n| key | default | unit | allowed | meaning |\n|---|---|---|---|---|\n";
  std::string out;
  std::string last = "-";
  for (const Row& row : rows) {
    const bool section = row.kind == Kind::kSection;
    const std::string heading = section ? row.key : "";
    if (heading != last) {
      if (!heading.empty()) out += "\n**" + heading + "**\n";
      if (!heading.empty() && !row.text.empty()) out += "\n" + std::string(row.text) + "\n";
      out += kHead;
    }
    last = heading;
    void* inside = section ? row.at(const_cast<void*>(s)) : const_cast<void*>(s);
    page_rows(section ? row.rows : std::vector<Row>{row}, inside, row.renew != nullptr, "", out);
  }
  return out;
}

std::vector<Row> flatten(const std::vector<Row>& rows) {
  std::vector<Row> out;
  flatten_into(rows, "", [](void* s, bool /*make*/) { return s; }, out);
  return out;
}

}  // namespace rosflight::config::detail
