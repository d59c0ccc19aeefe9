// SPDX-License-Identifier: BSD-3-Clause
#include "config/yaml.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace rf {
namespace {

struct Inner {
  double length_m = 0.1;
  std::string word = "a \"b\"";
  template <class V>
  void visit(V& v) {
    v("length_m", length_m, 0.01, 1.0, "m", "a length");
    v("word", word, "-", "a word");
  }
};

struct Outer {
  bool on = true;
  int count = 3;
  double free_number = 1e-300;
  Inner inner;
  template <class V>
  void visit(V& v) {
    v("on", on, "-", "a switch");
    v("count", count, 1, 9, "-", "a count");
    v("free_number", free_number, "s", "without range");
    v("inner", inner, "a section");
  }
};

std::string errorOf(const std::string& text) {
  Outer config;
  try {
    loadConfigText(text, "file.yaml", config);
  } catch (const ConfigError& e) {
    EXPECT_EQ(config.count, 3) << "a refused file must not change anything";
    return e.what();
  }
  return "no error";
}

TEST(ConfigYaml, LaysGivenFieldsOverDefaults) {
  Outer config;
  loadConfigText("count: 7\ninner:\n  length_m: 0.5\n", "t", config);
  EXPECT_EQ(config.count, 7);
  EXPECT_DOUBLE_EQ(config.inner.length_m, 0.5);
  EXPECT_TRUE(config.on);
  loadConfigText("", "t", config);
  loadConfigText("inner:\n", "t", config);
  EXPECT_EQ(config.count, 7);
}

TEST(ConfigYaml, NamesFileFieldValueAndRule) {
  EXPECT_EQ(errorOf("count: 12"), "file.yaml:1: count = 12: must be within 1..9 [-]");
  EXPECT_EQ(errorOf("count: 2.5"), "file.yaml:1: count = 2.5: must be a whole number");
  EXPECT_EQ(errorOf("on: maybe"), "file.yaml:1: on = maybe: must be true or false");
  EXPECT_EQ(errorOf("inner: {length_m: wide}"),
            "file.yaml:1: inner.length_m = wide: must be a number");
  EXPECT_EQ(errorOf("free_number: nan"), "file.yaml:1: free_number = nan: must be a finite number");
  EXPECT_EQ(errorOf("free_number: .inf"), "file.yaml:1: free_number = .inf: must be a number");
  EXPECT_EQ(errorOf("on: true\ninner:\n  lenght_m: 0.1"),
            "file.yaml:3: inner.lenght_m: is not a field that is known here");
  EXPECT_EQ(errorOf("count: 1\ncount: 2"), "file.yaml:2: count: is given twice");
  EXPECT_EQ(errorOf("inner: 3"), "file.yaml:1: inner: must be a section (a map of fields)");
  EXPECT_EQ(errorOf("count: [1, 2]"), "file.yaml:1: count: must be a single value");
  EXPECT_EQ(errorOf("- 1"), "file.yaml: must be a map of fields");
  EXPECT_NE(errorOf("a: [").find("not readable as YAML"), std::string::npos);
  EXPECT_NE(errorOf("count: 12\nfoo: 1").find('\n'), std::string::npos) << "all faults are told";
}

TEST(ConfigYaml, WritesWhatItReadsBack) {
  Outer config;
  config.count = 5;
  config.free_number = 0.1 + 0.2;
  config.inner.word = "x: \"#\\\n";
  const std::string text = writeConfig(config);
  Outer back;
  loadConfigText(text, "own", back);
  EXPECT_EQ(back.count, 5);
  EXPECT_EQ(back.free_number, config.free_number);
  EXPECT_EQ(back.inner.word, config.inner.word);
  EXPECT_EQ(writeConfig(back), text);
  EXPECT_NE(text.find("  length_m: 0.1  # [m] 0.01..1: a length"), std::string::npos) << text;
}

TEST(ConfigYaml, OverridesOneField) {
  Outer config;
  overrideConfig("inner.word=vo", config);
  EXPECT_EQ(config.inner.word, "vo");
  EXPECT_THROW(overrideConfig("inner.none=1", config), ConfigError);
  EXPECT_THROW(overrideConfig("inner.word", config), ConfigError);
}

TEST(ConfigYaml, ChecksValuesSetByCode) {
  Outer config;
  EXPECT_NO_THROW(checkConfig(config, "code"));
  config.inner.length_m = std::numeric_limits<double>::quiet_NaN();
  try {
    checkConfig(config, "code");
    FAIL();
  } catch (const ConfigError& e) {
    EXPECT_STREQ(e.what(), "code: inner.length_m = nan: must be a finite number");
  }
}

TEST(ConfigYaml, MissingFileIsAnError) {
  Outer config;
  EXPECT_THROW(loadConfigFile("/nonexistent/file.yaml", config), ConfigError);
}

}  // namespace
}  // namespace rf
