// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace rf {

/// A dense image plane: row-major, contiguous, no padding. Pixel (u, v) is column u, row v; the
/// CENTRE of a pixel has integer coordinates (the top-left corner of the image is (-0.5, -0.5)).
/// Value type: copies are deep. Distinct objects may be used from distinct threads.
template <typename T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, const T& value = T{}) : width_(width), height_(height) {
    if (width < 0 || height < 0) {
      throw std::invalid_argument("Image: negative size " + std::to_string(width) + "x" +
                                  std::to_string(height));
    }
    data_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value);
  }

  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t size() const { return data_.size(); }
  bool empty() const { return data_.empty(); }
  bool inside(int u, int v) const { return u >= 0 && v >= 0 && u < width_ && v < height_; }

  T& operator()(int u, int v) { return data_[index(u, v)]; }
  const T& operator()(int u, int v) const { return data_[index(u, v)]; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  T* row(int v) { return data_.data() + index(0, v); }
  const T* row(int v) const { return data_.data() + index(0, v); }
  T* data() { return data_.data(); }
  const T* data() const { return data_.data(); }
  auto begin() { return data_.begin(); }
  auto end() { return data_.end(); }
  auto begin() const { return data_.begin(); }
  auto end() const { return data_.end(); }

  bool operator==(const Image&) const = default;

 private:
  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(u);
  }

  int width_ = 0;
  int height_ = 0;
  std::vector<T> data_;
};

/// One colour sample, red first, 0..255.
struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  bool operator==(const Rgb&) const = default;
};

}  // namespace rf
