// SPDX-License-Identifier: BSD-3-Clause
#include "config/yaml.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

namespace rf::config_detail {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 20;

std::string join(const std::string& path, const std::string& name) {
  return path.empty() ? name : path + "." + name;
}

std::string parent(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? std::string() : path.substr(0, dot);
}

template <class T>
bool parseNumber(const std::string& text, T& value) {
  const char* begin = text.data();
  const char* end = begin + text.size();
  if (begin != end && *begin == '+') ++begin;
  const auto [stop, error] = std::from_chars(begin, end, value);
  return error == std::errc() && stop == end;
}

/// What is wrong with the value now in the field, or empty.
std::string rangeFault(const ConfigField& field) {
  double value = 0;
  if (const auto* const* d = std::get_if<double*>(&field.value)) {
    value = **d;
    if (!std::isfinite(value)) return "must be a finite number";
  } else if (const auto* const* i = std::get_if<int*>(&field.value)) {
    value = **i;
  } else {
    return {};
  }
  if (!field.range || (value >= field.range->first && value <= field.range->second)) return {};
  return fmt::format("must be within {}..{} [{}]", field.range->first, field.range->second,
                     field.unit);
}

std::string valueText(const ConfigField& field) {
  return std::visit(
      [](const auto* value) -> std::string {
        if constexpr (std::is_same_v<decltype(value), const std::string*>) {
          std::string quoted = "\"";
          for (const char c : *value) {
            if (c == '"' || c == '\\') quoted += '\\';
            if (c == '\n') {
              quoted += "\\n";
            } else {
              quoted += c;
            }
          }
          return quoted + "\"";
        } else {
          return fmt::format("{}", *value);
        }
      },
      std::variant<const bool*, const int*, const double*, const std::string*>(std::visit(
          [](auto* v) -> std::variant<const bool*, const int*, const double*, const std::string*> {
            return v;
          },
          field.value)));
}

/// Sets the field from a scalar; the violated rule, or empty.
std::string assign(const ConfigField& field, const YAML::Node& node) {
  if (!node.IsScalar()) return "must be a single value";
  const std::string& text = node.Scalar();
  if (auto* const* s = std::get_if<std::string*>(&field.value)) {
    **s = text;
    return {};
  }
  if (auto* const* b = std::get_if<bool*>(&field.value)) {
    if (text != "true" && text != "false") return "must be true or false";
    **b = text == "true";
    return {};
  }
  if (auto* const* i = std::get_if<int*>(&field.value)) {
    if (!parseNumber(text, **i)) return "must be a whole number";
  } else if (!parseNumber(text, *std::get<double*>(field.value))) {
    return "must be a number";
  }
  return rangeFault(field);
}

std::string readText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw ConfigError(path + ": cannot be opened for reading");
  std::string text(kMaxFileBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) throw ConfigError(path + ": cannot be read");
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kMaxFileBytes) throw ConfigError(path + ": larger than 1 MiB");
  return text;
}

}  // namespace

class Overlay::Reader : public ConfigVisitor {
 public:
  Reader(const std::string& text, std::string source) : source_(std::move(source)) {
    YAML::Node root;
    try {
      root = YAML::Load(text);
    } catch (const YAML::Exception& e) {
      throw ConfigError(
          fmt::format("{}:{}: not readable as YAML: {}", source_, e.mark.line + 1, e.msg));
    }
    if (root.IsNull() || !root.IsDefined()) root = YAML::Node(YAML::NodeType::Map);
    if (!root.IsMap()) throw ConfigError(source_ + ": must be a map of fields");
    open(root);
  }

  void field(const ConfigField& field) override {
    Level& level = levels_.back();
    level.known.insert(field.name);
    const YAML::Node node = find(level.node, field.name);
    if (!node.IsDefined()) return;
    const std::string fault = assign(field, node);
    if (fault.empty()) return;
    complain(node, field.name, node.IsScalar() ? " = " + node.Scalar() : std::string(), fault);
  }

  void enter(const std::string& name, const std::string& /*doc*/) override {
    levels_.back().known.insert(name);
    YAML::Node node = find(levels_.back().node, name);
    if (node.IsDefined() && !node.IsMap() && !node.IsNull()) {
      complain(node, name, {}, "must be a section (a map of fields)");
      node.reset(YAML::Node(YAML::NodeType::Map));
    }
    path_ = join(path_, name);
    open(node.IsDefined() && node.IsMap() ? node : YAML::Node(YAML::NodeType::Map));
  }

  void leave() override {
    close();
    path_ = parent(path_);
  }

  void finish() {
    close();
    if (!faults_.empty()) throw ConfigError(faults_);
  }

 private:
  struct Level {
    YAML::Node node;
    std::set<std::string> known;
  };

  static YAML::Node find(const YAML::Node& map, const std::string& name) {
    for (const auto& entry : map) {
      if (entry.first.IsScalar() && entry.first.Scalar() == name) return entry.second;
    }
    return YAML::Node(YAML::NodeType::Undefined);
  }

  void open(const YAML::Node& node) { levels_.push_back({node, {}}); }

  void close() {
    std::set<std::string> seen;
    for (const auto& entry : levels_.back().node) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "(not a word)";
      if (!levels_.back().known.contains(key)) {
        complain(entry.first, key, {}, "is not a field that is known here");
      } else if (!seen.insert(key).second) {
        complain(entry.first, key, {}, "is given twice");
      }
    }
    levels_.pop_back();
  }

  void complain(const YAML::Node& node, const std::string& name, const std::string& value,
                const std::string& fault) {
    if (!faults_.empty()) faults_ += '\n';
    faults_ += fmt::format("{}:{}: {}{}: {}", source_, node.Mark().line + 1, join(path_, name),
                           value, fault);
  }

  std::string source_;
  std::string path_;
  std::string faults_;
  std::vector<Level> levels_;
};

Overlay::Overlay(const std::string& text, std::string source)
    : reader_(std::make_unique<Reader>(text, std::move(source))) {}
Overlay::Overlay(Overlay&&) noexcept = default;
Overlay::~Overlay() = default;

Overlay Overlay::fromFile(const std::string& path) { return {readText(path), path}; }

Overlay Overlay::fromOverride(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw ConfigError("override \"" + assignment + "\": must be field=value");
  }
  std::string text;
  std::string indent;
  std::istringstream names(assignment.substr(0, equals));
  for (std::string name; std::getline(names, name, '.');) {
    if (!text.empty()) text += '\n';
    text += indent + name + ":";
    indent += "  ";
  }
  return {text + " " + assignment.substr(equals + 1), "override \"" + assignment + "\""};
}

ConfigVisitor& Overlay::visitor() { return *reader_; }
void Overlay::finish() { reader_->finish(); }

void Checker::field(const ConfigField& field) {
  const std::string fault = rangeFault(field);
  if (fault.empty()) return;
  if (!faults_.empty()) faults_ += '\n';
  faults_ +=
      fmt::format("{}: {} = {}: {}", source_, join(path_, field.name), valueText(field), fault);
}

void Checker::enter(const std::string& name, const std::string& /*doc*/) {
  path_ = join(path_, name);
}

void Checker::leave() { path_ = parent(path_); }

void Checker::finish() const {
  if (!faults_.empty()) throw ConfigError(faults_);
}

void Writer::field(const ConfigField& field) {
  text += fmt::format("{}{}: {}  # [{}]", indent_, field.name, valueText(field), field.unit);
  if (field.range) text += fmt::format(" {}..{}", field.range->first, field.range->second);
  text += ": " + field.doc + "\n";
}

void Writer::enter(const std::string& name, const std::string& doc) {
  text += fmt::format("{}{}:  # {}\n", indent_, name, doc);
  indent_ += "  ";
}

void Writer::leave() { indent_.resize(indent_.size() - 2); }

}  // namespace rf::config_detail
