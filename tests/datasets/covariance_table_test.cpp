// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/covariance_table.hpp"

#include <gtest/gtest.h>

#include "datasets/error.hpp"
#include "temp_folder.hpp"

namespace rf {
namespace {

Mat6 numbered(double scale) {
  Mat6 m;
  for (int r = 0; r < 6; ++r) {
    for (int c = r; c < 6; ++c) m(r, c) = m(c, r) = scale * (10 * r + c + 1);
  }
  return m;
}

TEST(CovarianceTable, WhatIsWrittenIsRead) {
  const TempFolder folder;
  const std::string path = folder / "covariance.csv";
  CovarianceTable table(path);
  ModelState state;
  state.utime = 1500000;
  state.camera.covariance = numbered(1e-6);
  state.camera.health = Health::kPriorOnly;
  table.add(state);
  state.utime = 1533333;
  state.object_exists = true;
  state.object.covariance = numbered(2e-6);
  state.object.health = Health::kTracked;
  table.add(state);
  const CovarianceFile file = readCovariances(path);
  ASSERT_EQ(file.camera.size(), 2U);
  ASSERT_EQ(file.object.size(), 1U);
  EXPECT_EQ(file.camera[0].utime, 1500000);
  EXPECT_EQ(file.camera[0].health, Health::kPriorOnly);
  EXPECT_LT((file.camera[0].covariance - numbered(1e-6)).norm(), 1e-10);
  EXPECT_EQ(file.object[0].utime, 1533333);
  EXPECT_EQ(file.object[0].health, Health::kTracked);
  EXPECT_LT((file.object[0].covariance - numbered(2e-6)).norm(), 1e-10);
  EXPECT_EQ(TempFolder::read(path).rfind("timestamp,body,health,c00,c01,c02,", 0), 0U);
}

TEST(CovarianceTable, BadRowsAreNamed) {
  const TempFolder folder;
  std::string values;
  for (int i = 0; i < 21; ++i) values += ",1";
  const auto refused = [&](const std::string& row) -> std::string {
    folder.write("c.csv", row + "\n");
    try {
      readCovariances(folder / "c.csv");
    } catch (const DatasetError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(refused("1.0,camera,tracked" + values), "");
  EXPECT_NE(refused("1.0,camera,tracked,1").find("c.csv:1: 4 columns"), std::string::npos);
  EXPECT_NE(refused("x,camera,tracked" + values).find("timestamp = x"), std::string::npos);
  EXPECT_NE(refused("1.0,cat,tracked" + values).find("body = cat"), std::string::npos);
  EXPECT_NE(refused("1.0,camera,fine" + values).find("health = fine"), std::string::npos);
  EXPECT_NE(refused("1.0,camera,tracked,nan" + values.substr(2)).find("c00 = nan"),
            std::string::npos);
  const std::string row = "1.0,object,lost" + values;
  EXPECT_NE(refused(row + "\n" + row).find(":2: timestamp"), std::string::npos);
}

}  // namespace
}  // namespace rf
