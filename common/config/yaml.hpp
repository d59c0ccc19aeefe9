// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

namespace rf {

/// A configuration that cannot be used. The text names file, field (dotted path), value and the
/// violated rule, one line for each fault found.
class ConfigError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a struct says of one of its fields.
struct ConfigField {
  std::string name;
  std::variant<bool*, int*, double*, std::string*> value;
  std::optional<std::pair<double, double>> range;  ///< inclusive
  std::string unit;                                ///< "-" when there is none
  std::string doc;
};

/// The V of `template <class V> void visit(V&)` (config/visit.hpp): turns the calls of a struct
/// into a walk over fields and sections.
class ConfigVisitor {
 public:
  virtual ~ConfigVisitor() = default;
  virtual void field(const ConfigField& field) = 0;
  virtual void enter(const std::string& name, const std::string& doc) = 0;
  virtual void leave() = 0;

  template <class T>
  void operator()(const char* name, T& value, const char* unit, const char* doc) {
    field({name, &value, std::nullopt, unit, doc});
  }
  template <class T>
  void operator()(const char* name, T& value, double low, double high, const char* unit,
                  const char* doc) {
    field({name, &value, std::pair{low, high}, unit, doc});
  }
  template <class S>
  void operator()(const char* name, S& section, const char* doc) {
    enter(name, doc);
    section.visit(*this);
    leave();
  }
};

template <class S>
concept ConfigStruct = requires(S& s, ConfigVisitor& v) {
  s.visit(v);
};

namespace config_detail {

/// A parsed file, or one `a.b=value` override, that is laid over a struct.
class Overlay {
 public:
  /// Throws ConfigError when `text` is no YAML map. `source` names it in messages.
  Overlay(const std::string& text, std::string source);
  Overlay(Overlay&&) noexcept;
  ~Overlay();
  static Overlay fromFile(const std::string& path);
  static Overlay fromOverride(const std::string& assignment);
  /// Reads what is given into the visited fields; `finish` throws if anything was wrong.
  ConfigVisitor& visitor();
  void finish();

 private:
  class Reader;
  std::unique_ptr<Reader> reader_;
};

/// Throws ConfigError when a visited value is outside its range or not finite.
class Checker : public ConfigVisitor {
 public:
  explicit Checker(std::string source) : source_(std::move(source)) {}
  void field(const ConfigField& field) override;
  void enter(const std::string& name, const std::string& doc) override;
  void leave() override;
  void finish() const;

 private:
  std::string source_;
  std::string path_;
  std::string faults_;
};

class Writer : public ConfigVisitor {
 public:
  void field(const ConfigField& field) override;
  void enter(const std::string& name, const std::string& doc) override;
  void leave() override;
  std::string text;

 private:
  std::string indent_;
};

template <ConfigStruct S>
void apply(Overlay overlay, S& config) {
  S changed = config;
  changed.visit(overlay.visitor());
  overlay.finish();
  config = std::move(changed);
}

}  // namespace config_detail

/// Lays the YAML file over `config`: fields that the file does not name keep their values. Unknown
/// or doubled keys, wrong types, values out of range and non-finite numbers throw ConfigError, and
/// `config` is then unchanged. Files above 1 MiB are refused.
template <ConfigStruct S>
void loadConfigFile(const std::string& path, S& config) {
  config_detail::apply(config_detail::Overlay::fromFile(path), config);
}

/// The same from text; `source` stands for the file name in messages.
template <ConfigStruct S>
void loadConfigText(const std::string& text, const std::string& source, S& config) {
  config_detail::apply(config_detail::Overlay(text, source), config);
}

/// One override as a command line gives it: "segmentation.mode=vo".
template <ConfigStruct S>
void overrideConfig(const std::string& assignment, S& config) {
  config_detail::apply(config_detail::Overlay::fromOverride(assignment), config);
}

/// Checks ranges and finiteness of values that were set by code; throws ConfigError.
template <ConfigStruct S>
void checkConfig(S config, const std::string& source) {
  config_detail::Checker checker(source);
  config.visit(checker);
  checker.finish();
}

/// The whole configuration as YAML, every field with its unit, range and meaning as a comment.
/// Reading it back gives the same values to the bit.
template <ConfigStruct S>
std::string writeConfig(S config) {
  config_detail::Writer writer;
  config.visit(writer);
  return writer.text;
}

}  // namespace rf
