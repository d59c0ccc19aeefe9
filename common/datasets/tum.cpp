// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/tum.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <tuple>

#include <fmt/format.h>

#include "datasets/error.hpp"
#include "datasets/image_files.hpp"
#include "datasets/text.hpp"

namespace rf {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 4> kAssociationFiles = {"associated.txt", "associations.txt",
                                                          "rgbd_assoc.txt", "assoc.txt"};

std::string inFolder(const std::string& folder, const std::string& name) {
  return (fs::path(folder) / name).string();
}

std::int64_t requireTime(const std::string& list, const TextLine& line, const std::string& word) {
  const auto utime = parseTimestamp(word);
  if (!utime) {
    throw DatasetError(
        fmt::format("{}:{}: timestamp = {}: must be seconds", list, line.number, word));
  }
  return *utime;
}

/// Puts items into increasing time and drops those whose time is taken.
template <class Item>
void sortByTime(std::vector<Item>& items, const std::string& list, TumIndex& index) {
  std::stable_sort(items.begin(), items.end(),
                   [](const Item& a, const Item& b) { return a.utime < b.utime; });
  std::vector<Item> unique;
  for (Item& item : items) {
    if (!unique.empty() && unique.back().utime == item.utime) {
      ++index.dropped_lines;
      index.warnings.push_back(list + ": timestamp " + formatTimestamp(item.utime) +
                               " is given twice, the later line is dropped");
      continue;
    }
    unique.push_back(std::move(item));
  }
  items = std::move(unique);
}

std::vector<TumImage> readList(const std::string& folder, const std::string& name,
                               TumIndex& index) {
  const std::string list = inFolder(folder, name);
  std::vector<TumImage> images;
  for (const TextLine& line : readTextLines(list)) {
    if (line.words.size() < 2) {
      throw DatasetError(fmt::format("{}:{}: must be timestamp and file name", list, line.number));
    }
    images.push_back({requireTime(list, line, line.words[0]), inFolder(folder, line.words[1])});
  }
  sortByTime(images, list, index);
  return images;
}

/// Whether the first of the two files is the depth image: by name, else by its header (16-bit
/// grey).
bool depthFirst(const std::string& folder, const std::string& list, const TextLine& line) {
  const std::string& first = line.words[1];
  const std::string& second = line.words[3];
  const bool first_named = first.find("depth") != std::string::npos;
  const bool second_named = second.find("depth") != std::string::npos;
  if (first_named != second_named) return first_named;
  try {
    const bool first_deep = readImageHeader(inFolder(folder, first)).bits == 16;
    const bool second_deep = readImageHeader(inFolder(folder, second)).bits == 16;
    if (first_deep != second_deep) return first_deep;
  } catch (const DatasetError&) {
    // an unreadable image decides nothing: the message below tells which line
  }
  throw DatasetError(
      fmt::format("{}:{}: cannot tell depth from colour: neither by file name nor "
                  "by 16-bit image",
                  list, line.number));
}

TumIndex readAssociation(const std::string& folder, const std::string& list) {
  TumIndex index;
  std::optional<bool> depth_first;
  for (const TextLine& line : readTextLines(list)) {
    if (line.words.size() < 4) {
      throw DatasetError(fmt::format("{}:{}: must be time file time file", list, line.number));
    }
    if (!depth_first) depth_first = depthFirst(folder, list, line);
    const std::size_t depth = *depth_first ? 0 : 2;
    const std::size_t colour = 2 - depth;
    index.frames.push_back(
        {requireTime(list, line, line.words[depth]), requireTime(list, line, line.words[colour]),
         inFolder(folder, line.words[colour + 1]), inFolder(folder, line.words[depth + 1])});
  }
  sortByTime(index.frames, list, index);
  return index;
}

struct Candidate {
  std::int64_t difference = 0;
  std::size_t depth = 0;
  std::size_t colour = 0;
  auto key() const { return std::tie(difference, depth, colour); }
};

std::vector<Candidate> closePairs(const std::vector<TumImage>& depth,
                                  const std::vector<TumImage>& colour, std::int64_t limit) {
  std::vector<Candidate> pairs;
  std::size_t begin = 0;
  for (std::size_t d = 0; d < depth.size(); ++d) {
    while (begin < colour.size() && colour[begin].utime < depth[d].utime - limit) ++begin;
    for (std::size_t c = begin; c < colour.size() && colour[c].utime <= depth[d].utime + limit;
         ++c) {
      pairs.push_back({std::abs(colour[c].utime - depth[d].utime), d, c});
    }
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const Candidate& a, const Candidate& b) { return a.key() < b.key(); });
  return pairs;
}

}  // namespace

TumIndex associate(const std::vector<TumImage>& depth, const std::vector<TumImage>& colour,
                   std::int64_t max_difference_us) {
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> colour_of(depth.size(), kNone);
  std::vector<bool> taken(colour.size(), false);
  for (const Candidate& pair : closePairs(depth, colour, max_difference_us)) {
    if (colour_of[pair.depth] != kNone || taken[pair.colour]) continue;
    colour_of[pair.depth] = pair.colour;
    taken[pair.colour] = true;
  }
  TumIndex index;
  for (std::size_t d = 0; d < depth.size(); ++d) {
    if (colour_of[d] == kNone) {
      ++index.depth_without_colour;
      continue;
    }
    const TumImage& c = colour[colour_of[d]];
    index.frames.push_back({depth[d].utime, c.utime, c.path, depth[d].path});
  }
  index.colour_without_depth = colour.size() - index.frames.size();
  return index;
}

TumIndex indexTumFolder(const std::string& folder) {
  if (!fs::is_directory(folder)) throw DatasetError(folder + ": is no folder");
  const bool has_lists =
      fs::exists(inFolder(folder, "rgb.txt")) && fs::exists(inFolder(folder, "depth.txt"));
  if (has_lists) {
    TumIndex notes;
    const std::vector<TumImage> depth = readList(folder, "depth.txt", notes);
    const std::vector<TumImage> colour = readList(folder, "rgb.txt", notes);
    TumIndex index = associate(depth, colour);
    index.dropped_lines = notes.dropped_lines;
    index.warnings = std::move(notes.warnings);
    return index;
  }
  for (const char* name : kAssociationFiles) {
    const std::string list = inFolder(folder, name);
    if (fs::exists(list)) return readAssociation(folder, list);
  }
  throw DatasetError(folder + ": has neither rgb.txt and depth.txt nor associated.txt");
}

TumDataset::TumDataset(const std::string& folder, const std::optional<Calibration>& calibration)
    : index_(indexTumFolder(folder)) {
  calibration_ = calibration ? *calibration : readCalibration(inFolder(folder, "camera.yaml"));
  if (const auto problem = calibration_.camera.problem()) {
    throw DatasetError(folder + ": " + *problem);
  }
}

TumDataset::Loaded TumDataset::load(std::size_t i) const {
  const TumEntry& entry = index_.frames.at(i);
  const Camera& camera = calibration_.camera;
  try {
    RgbdFrame frame;
    frame.utime = entry.utime;
    frame.colour_utime = entry.colour_utime;
    frame.seq = static_cast<std::int64_t>(i);
    frame.depth_mm = depthToMillimetres(
        readDepthImage(entry.depth_path, camera.width, camera.height), calibration_.depth_factor);
    frame.colour = readColourImage(entry.colour_path, camera.width, camera.height);
    return {std::move(frame), {}};
  } catch (const DatasetError& e) {
    return {std::nullopt, e.what()};
  }
}

}  // namespace rf
