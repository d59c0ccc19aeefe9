// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rf {

/// Whether a body that moved until a moment ago may still be moving. One body explains a frame as
/// soon as what the other moved over the window is too little to be seen; it has come to rest when
/// that has held for as long as the window itself.
class Settling {
 public:
  explicit Settling(int frames) : frames_(frames) {}

  void note(bool moving) {
    if (moving) {
      moved_ = rested_ > frames_ ? 1 : moved_ + 1;
      rested_ = 0;
    } else {
      ++rested_;
    }
  }

  /// After this many frames of motion at least, so that a false alarm of one frame stays one frame.
  bool inDoubt() const { return moved_ > frames_ && rested_ > 0 && rested_ <= frames_; }

 private:
  int frames_;
  int moved_ = 0;   ///< frames, since the body last rested
  int rested_ = 0;  ///< frames, since it last moved
};

}  // namespace rf
