// SPDX-License-Identifier: BSD-3-Clause
#include "text_files.hpp"

#include <fstream>
#include <stdexcept>

#include <fmt/format.h>

namespace rf {

std::string stampText(std::int64_t utime) {
  return fmt::format("{}.{:06d}", utime / 1'000'000, utime % 1'000'000);
}

std::string tumLine(std::int64_t utime, const SE3& T) {
  return fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", stampText(utime),
                     T.t.x(), T.t.y(), T.t.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w());
}

void writeText(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace rf
