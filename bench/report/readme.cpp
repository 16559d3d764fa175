#include "report/readme.h"

#include "report/readme_data.h"
#include "tool/command.h"
#include "tool/html.h"
#include "tool/table.h"

#include <winnow/partitions/partition.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace winnow::bench {
namespace {

constexpr std::size_t kReadmeWidth = 104;
const std::string kTableBegin = "<!-- table ";
const std::string kTableEnd = "<!-- end of table -->";

/// A row or a column of a table in the making: how it is headed, and what it says of its figures.
struct ReadmeLine {
  std::string head;
  Json says = Json::object();
};

/// What a figure, a column, a row and a table say, the first of them first.
class ReadmeContext {
 public:
  ReadmeContext(std::initializer_list<const Json*> levels) : levels_(levels) {}

  [[nodiscard]] std::string text(const char* member) const {
    for (const Json* level : levels_) {
      if (level->contains(member)) return (*level)[member];
    }
    return "";
  }
  /// Of all levels; of a member that several have the first.
  [[nodiscard]] Json where() const {
    Json all = Json::object();
    for (const Json* level : levels_) {
      if (!level->contains("where")) continue;
      for (const auto& [name, value] : (*level)["where"].items()) {
        if (!all.contains(name)) all[name] = value;
      }
    }
    return all;
  }

 private:
  std::vector<const Json*> levels_;
};

bool is_one_of(const Json& value, const Json& wanted) {
  if (!wanted.is_array()) return value == wanted;
  return std::find(wanted.begin(), wanted.end(), value) != wanted.end();
}

class ReadmeTables {
 public:
  explicit ReadmeTables(const Results& results) : results_(results) {}

  [[nodiscard]] std::string made(const Json& spec) const {
    return spec.contains("text") ? paragraph(spec) : table(spec);
  }

 private:
  const Results& results_;

  [[nodiscard]] std::vector<const Json*> rows(const ReadmeContext& context) const {
    std::vector<const Json*> found = results_.rows(context.text("table"));
    const Json where = context.where();
    std::erase_if(found, [&](const Json* row) {
      return std::any_of(where.items().begin(), where.items().end(), [&](const auto& member) {
        const Json wanted =
            member.value() == "@isa" ? results_.document()["machine"]["isa"] : member.value();
        return !row->contains(member.key()) || !is_one_of((*row)[member.key()], wanted);
      });
    });
    return found;
  }

  /// Of the row that is meant; "-" if there is none.
  [[nodiscard]] std::string figure(const Json& part, const ReadmeContext& context) const {
    if (part.contains("machine")) {
      const Json& machine = results_.document()["machine"];
      return key_text(machine.value(part["machine"].get<std::string>(), Json("unknown")));
    }
    const std::string name = part["value"];
    const Json* column = results_.column(context.text("table"), name);
    auto found = rows(context);
    std::erase_if(found, [&](const Json* row) { return !row->contains(name); });
    if (column == nullptr || found.empty()) return "-";
    const Json* row = found.front();
    if (part.value("sum", false)) {
      double sum = 0.0;
      for (const Json* one : found) sum += value_of(*one, name);
      return shown(sum, (*column)["format"].get<std::string>());
    }
    const bool most = part.value("most", false);
    if (most || part.value("least", false)) {
      row = *std::min_element(found.begin(), found.end(), [&](const Json* a, const Json* b) {
        return most ? value_of(*a, name) > value_of(*b, name)
                    : value_of(*a, name) < value_of(*b, name);
      });
    } else if (found.size() > 1) {
      throw ArgumentError("readme.json: " + part.dump() + " could be that of " +
                          (*row)["id"].get<std::string>() + " or of " +
                          (*found[1])["id"].get<std::string>());
    }
    return shown(*row, *column);
  }

  /// The parts of a cell or text together; whether any figure of them is known.
  [[nodiscard]] std::pair<std::string, bool> filled(const Json& parts, const Json& column,
                                                    const Json& row, const Json& spec) const {
    std::string text;
    bool known = false;
    for (const Json& part : parts) {
      if (part.is_string()) {
        text += part.get<std::string>();
        continue;
      }
      const std::string shown_figure = figure(part, {&part, &column, &row, &spec});
      known = known || shown_figure != "-";
      text += shown_figure;
    }
    return {known ? text : "-", known};
  }

  [[nodiscard]] std::vector<ReadmeLine> lines_of(const std::string& key, const Json& says,
                                                 const Json& spec) const {
    std::vector<ReadmeLine> lines;
    for (const Json& value : distinct(rows({&says, &spec}), key)) {
      Json line = says;
      line["where"][key] = value;
      lines.push_back({key_text(value), std::move(line)});
    }
    return lines;
  }

  [[nodiscard]] std::vector<ReadmeLine> columns(const Json& spec) const {
    std::vector<ReadmeLine> all;
    for (const Json& column : spec["columns"]) {
      if (!column.contains("each")) {
        all.push_back({column["head"], column});
        continue;
      }
      for (ReadmeLine& line : lines_of(column["each"], column, spec)) {
        all.push_back(std::move(line));
      }
    }
    return all;
  }

  [[nodiscard]] std::vector<ReadmeLine> table_rows(const Json& spec) const {
    if (spec["rows"].is_object()) return lines_of(spec["rows"]["key"], spec["rows"], spec);
    std::vector<ReadmeLine> all;
    for (const Json& row : spec["rows"]) all.push_back({row["head"], row});
    return all;
  }

  /// Names of partitions are code.
  [[nodiscard]] static std::string headed(const std::string& name) {
    const auto names = partition_names();
    return std::find(names.begin(), names.end(), name) == names.end() ? name : "`" + name + "`";
  }

  [[nodiscard]] std::string table(const Json& spec) const {
    const auto heads = columns(spec);
    std::string text = "| " + spec.value("corner", "") + (spec.contains("corner") ? " |" : "|");
    std::string under = "|---|";
    for (const ReadmeLine& head : heads) {
      text += " " + head.head + " |";
      under += "---|";
    }
    text += "\n" + under + "\n";
    bool any = false;
    for (const ReadmeLine& row : table_rows(spec)) {
      std::string line = "| " + headed(row.head) + " |";
      bool known = false;
      for (const ReadmeLine& head : heads) {
        const Json& parts = row.says.contains("cell") ? row.says["cell"] : head.says["cell"];
        const auto [cell, of_cell] = filled(parts, head.says, row.says, spec);
        line += " " + cell + " |";
        known = known || of_cell;
      }
      any = any || known;
      if (known) text += line + "\n";
    }
    if (!any) throw ArgumentError(no_figures(spec));
    return text;
  }

  /// All of its figures must be known.
  [[nodiscard]] std::string paragraph(const Json& spec) const {
    const Json none = Json::object();
    for (const Json& part : spec["text"]) {
      if (part.is_object() && figure(part, {&part, &spec}) == "-") {
        throw ArgumentError(no_figures(spec) + ": " + part.dump());
      }
    }
    const std::string text = filled(spec["text"], none, none, spec).first;
    std::istringstream words(text);
    std::string wrapped;
    std::size_t column = 0;
    for (std::string word; words >> word;) {
      if (column > 0 && column + 1 + word.size() > kReadmeWidth) {
        wrapped += '\n';
        column = 0;
      }
      if (column > 0) wrapped += ' ';
      column += (column > 0 ? 1 : 0) + word.size();
      wrapped += word;
    }
    return wrapped + "\n";
  }

  [[nodiscard]] static std::string no_figures(const Json& spec) {
    return "the results have no figures for the table " + spec["name"].get<std::string>();
  }
};

const Json& spec_named(const Json& specs, const std::string& name) {
  for (const Json& spec : specs) {
    if (spec["name"] == name) return spec;
  }
  throw ArgumentError("readme.json knows no table " + name);
}

}  // namespace

std::string readme_with_tables(const std::string& readme, const Results& results) {
  const Json specs = Json::parse(kReadmeJson);
  const ReadmeTables tables(results);
  std::string text;
  std::size_t at = 0;
  for (std::size_t begin = 0; (begin = readme.find(kTableBegin, at)) != std::string::npos;) {
    const std::size_t name_at = begin + kTableBegin.size();
    const std::size_t close = readme.find(" -->\n", name_at);
    const std::size_t end = readme.find(kTableEnd, name_at);
    if (close == std::string::npos || end == std::string::npos || end < close) {
      throw ArgumentError("a table without an end: " + readme.substr(begin, 40));
    }
    const std::string name = readme.substr(name_at, close - name_at);
    // Markdown wants a blank line between a comment and a table.
    text += readme.substr(at, close + 5 - at) + "\n" + tables.made(spec_named(specs, name)) + "\n";
    at = end;
  }
  return text + readme.substr(at);
}

}  // namespace winnow::bench
