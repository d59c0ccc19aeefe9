// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/ply.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "datasets/error.hpp"

namespace rf {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY files are written as memory is");

constexpr std::size_t kMaxHeaderLines = 1000;
constexpr const char* kProperties[] = {"x",  "y",  "z",  "red",    "green",     "blue",
                                       "nx", "ny", "nz", "radius", "confidence"};

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

const std::map<std::string, Type>& typeNames() {
  static const std::map<std::string, Type> kNames = {
      {"char", Type::kInt8},     {"int8", Type::kInt8},     {"uchar", Type::kUint8},
      {"uint8", Type::kUint8},   {"short", Type::kInt16},   {"int16", Type::kInt16},
      {"ushort", Type::kUint16}, {"uint16", Type::kUint16}, {"int", Type::kInt32},
      {"int32", Type::kInt32},   {"uint", Type::kUint32},   {"uint32", Type::kUint32},
      {"float", Type::kFloat},   {"float32", Type::kFloat}, {"double", Type::kDouble},
      {"float64", Type::kDouble}};
  return kNames;
}

std::size_t sizeOf(Type type) {
  switch (type) {
    case Type::kInt8:
    case Type::kUint8:
      return 1;
    case Type::kInt16:
    case Type::kUint16:
      return 2;
    case Type::kInt32:
    case Type::kUint32:
    case Type::kFloat:
      return 4;
    case Type::kDouble:
      break;
  }
  return 8;
}

template <class T>
double load(const char* p) {
  T value;
  std::memcpy(&value, p, sizeof value);
  return static_cast<double>(value);
}

double loadAs(Type type, const char* p) {
  switch (type) {
    case Type::kInt8:
      return load<std::int8_t>(p);
    case Type::kUint8:
      return load<std::uint8_t>(p);
    case Type::kInt16:
      return load<std::int16_t>(p);
    case Type::kUint16:
      return load<std::uint16_t>(p);
    case Type::kInt32:
      return load<std::int32_t>(p);
    case Type::kUint32:
      return load<std::uint32_t>(p);
    case Type::kFloat:
      return load<float>(p);
    case Type::kDouble:
      break;
  }
  return load<double>(p);
}

std::uint8_t toByte(double value) {
  return std::isfinite(value) ? static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0)) : 0;
}

void setProperty(SurfelPoint& point, const std::string& name, double value) {
  const float f = static_cast<float>(value);
  if (name == "x") point.x = f;
  if (name == "y") point.y = f;
  if (name == "z") point.z = f;
  if (name == "nx") point.nx = f;
  if (name == "ny") point.ny = f;
  if (name == "nz") point.nz = f;
  if (name == "red") point.red = toByte(value);
  if (name == "green") point.green = toByte(value);
  if (name == "blue") point.blue = toByte(value);
  if (name == "radius") point.radius = f;
  if (name == "confidence") point.confidence = f;
}

struct Property {
  std::string name;
  Type type = Type::kFloat;
};

struct Header {
  bool ascii = false;
  std::size_t count = 0;
  std::vector<Property> properties;
};

[[noreturn]] void refuse(const std::string& path, const std::string& rule) {
  throw DatasetError(path + ": " + rule);
}

Header readHeader(const std::string& path, std::istream& in) {
  Header header;
  std::string line;
  std::getline(in, line);
  if (line != "ply" && line != "ply\r") refuse(path, "is no PLY file");
  bool has_vertices = false;
  bool in_vertices = false;
  for (std::size_t n = 0; n < kMaxHeaderLines && std::getline(in, line); ++n) {
    std::istringstream words(line);
    std::string key;
    std::string first;
    std::string second;
    words >> key >> first;
    if (key == "end_header") {
      if (!has_vertices) refuse(path, "has no vertex element");
      return header;
    }
    if (key == "format") {
      if (first != "ascii" && first != "binary_little_endian") {
        refuse(path, "format " + first + ": must be ascii or binary_little_endian");
      }
      header.ascii = first == "ascii";
    } else if (key == "element") {
      if (first != "vertex" && !has_vertices) refuse(path, "vertices must be the first element");
      in_vertices = first == "vertex";
      if (in_vertices && !(words >> header.count)) refuse(path, "vertex count is unreadable");
      has_vertices = true;
    } else if (key == "property" && in_vertices) {
      const auto type = typeNames().find(first);
      if (type == typeNames().end() || !(words >> second)) {
        refuse(path, "vertex property \"" + line + "\": must be a scalar with a name");
      }
      header.properties.push_back({second, type->second});
    }
  }
  refuse(path, "header does not end");
}

void requireXyz(const std::string& path, const Header& header) {
  for (const char* name : {"x", "y", "z"}) {
    bool found = false;
    for (const Property& p : header.properties) found = found || p.name == name;
    if (!found) refuse(path, std::string("vertex property ") + name + ": is missing");
  }
}

std::vector<char> readRest(const std::string& path, std::ifstream& in) {
  const std::streamoff begin = in.tellg();
  in.seekg(0, std::ios::end);
  const std::streamoff end = in.tellg();
  if (begin < 0 || end < begin) refuse(path, "cannot be read");
  std::vector<char> bytes(static_cast<std::size_t>(end - begin));
  in.seekg(begin);
  in.read(bytes.data(), std::ssize(bytes));
  if (!in) refuse(path, "cannot be read");
  return bytes;
}

std::vector<SurfelPoint> parseBinary(const std::string& path, const Header& header,
                                     const std::vector<char>& bytes) {
  std::size_t stride = 0;
  for (const Property& p : header.properties) stride += sizeOf(p.type);
  if (header.count > bytes.size() / stride) {
    refuse(path, fmt::format("{} vertices of {} bytes do not fit the file: truncated", header.count,
                             stride));
  }
  std::vector<SurfelPoint> points(header.count);
  const char* at = bytes.data();
  for (SurfelPoint& point : points) {
    for (const Property& p : header.properties) {
      setProperty(point, p.name, loadAs(p.type, at));
      at += sizeOf(p.type);
    }
  }
  return points;
}

std::vector<SurfelPoint> parseAscii(const std::string& path, const Header& header,
                                    const std::vector<char>& bytes) {
  if (header.count > bytes.size() / 2) refuse(path, "is truncated");
  std::istringstream in(std::string(bytes.begin(), bytes.end()));
  std::vector<SurfelPoint> points(header.count);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const Property& p : header.properties) {
      double value = 0;
      if (!(in >> value)) refuse(path, fmt::format("vertex {}: unreadable or truncated", i));
      setProperty(points[i], p.name, value);
    }
  }
  return points;
}

void append(std::string& out, float value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  out.append(raw, sizeof raw);
}

void append(std::string& out, std::uint8_t value) { out.push_back(static_cast<char>(value)); }

void appendPoint(std::string& out, const SurfelPoint& p) {
  for (const float f : {p.x, p.y, p.z}) append(out, f);
  for (const std::uint8_t c : {p.red, p.green, p.blue}) append(out, c);
  for (const float f : {p.nx, p.ny, p.nz, p.radius, p.confidence}) append(out, f);
}

}  // namespace

void writePly(const std::string& path, const std::vector<SurfelPoint>& points) {
  std::string out =
      fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", points.size());
  for (const char* name : kProperties) {
    const bool is_colour = std::strlen(name) > 2 && std::strchr("rgb", name[0]) != nullptr &&
                           std::strcmp(name, "radius") != 0;
    out += fmt::format("property {} {}\n", is_colour ? "uchar" : "float", name);
  }
  out += "end_header\n";
  for (const SurfelPoint& point : points) appendPoint(out, point);

  const std::string partial = path + ".part";
  std::ofstream file(partial, std::ios::binary | std::ios::trunc);
  file.write(out.data(), std::ssize(out));
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(partial, path, error);
  if (!file || error) refuse(path, "cannot be written");
}

std::vector<SurfelPoint> readPly(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse(path, "cannot be opened for reading");
  const Header header = readHeader(path, file);
  requireXyz(path, header);
  const std::vector<char> bytes = readRest(path, file);
  std::vector<SurfelPoint> points =
      header.ascii ? parseAscii(path, header, bytes) : parseBinary(path, header, bytes);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SurfelPoint& p = points[i];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      refuse(path, fmt::format("vertex {}: position must be finite", i));
    }
  }
  return points;
}

}  // namespace rf
