// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

namespace rf {
namespace {

RgbdFrame makeFrame(int width, int height, unsigned seed) {
  std::mt19937_64 random(seed);
  RgbdFrame frame;
  frame.utime = 1305031102160407;
  frame.colour_utime = 1305031102150000;
  frame.seq = 7;
  frame.colour = Image<Rgb>(width, height);
  frame.depth_mm = Image<std::uint16_t>(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const auto wave =
          static_cast<std::uint8_t>(128 + 100 * std::sin(0.05 * u) * std::cos(0.04 * v));
      frame.colour(u, v) = {wave, static_cast<std::uint8_t>(255 - wave),
                            static_cast<std::uint8_t>(u / 3)};
      frame.depth_mm(u, v) = static_cast<std::uint16_t>(random() % 5000);
    }
  }
  return frame;
}

void expectNear(const Image<Rgb>& a, const Image<Rgb>& b) {
  ASSERT_EQ(a.size(), b.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i].g - b[i].g);
  EXPECT_LT(sum / static_cast<double>(a.size()), 4.0);
}

TEST(Codec, DepthAndNumbersAreExactColourIsClose) {
  for (const auto& [w, h] : {std::pair{640, 480}, {321, 241}, {1, 1}, {17, 3}}) {
    const RgbdFrame frame = makeFrame(w, h, 1);
    const auto back = decode(encode(frame));
    ASSERT_TRUE(back) << back.error;
    EXPECT_EQ(back->utime, frame.utime);
    EXPECT_EQ(back->colour_utime, frame.colour_utime);
    EXPECT_EQ(back->seq, frame.seq);
    EXPECT_EQ(back->depth_mm, frame.depth_mm);
    if (w > 100) expectNear(back->colour, frame.colour);
  }
}

TEST(Codec, RoundTripIsWhatAReceiverSees) {
  const RgbdFrame frame = makeFrame(320, 240, 2);
  const RgbdFrame once = roundTrip(frame);
  const auto wire = decode(encode(frame));
  ASSERT_TRUE(wire);
  EXPECT_EQ(once.colour, wire->colour);
  EXPECT_EQ(once.depth_mm, wire->depth_mm);
}

TEST(Codec, LosslessKeepsEveryColour) {
  const RgbdFrame frame = makeFrame(64, 48, 3);
  const CodecOptions options{.lossless = true};
  const auto back = decode(encode(frame, options));
  ASSERT_TRUE(back) << back.error;
  EXPECT_EQ(back->colour, frame.colour);
  EXPECT_EQ(roundTrip(frame, options).colour, frame.colour);
}

TEST(Codec, AcceptsForeignRawBgrAndRawDepth) {
  const RgbdFrame frame = makeFrame(4, 2, 4);
  EncodedFrame encoded = encode(frame, {.lossless = true});
  encoded.colour_format = ColourFormat::kBgr;
  encoded.depth_zipped = false;
  encoded.depth.resize(16);
  const auto back = decode(encoded);
  ASSERT_TRUE(back) << back.error;
  EXPECT_EQ(back->colour(1, 1).r, frame.colour(1, 1).b);
}

TEST(Codec, RefusesEverySizeThatDoesNotFit) {
  const EncodedFrame good = encode(makeFrame(64, 48, 5));
  const auto errorOf = [&](const auto& change) {
    EncodedFrame bad = good;
    change(bad);
    const auto result = decode(bad);
    EXPECT_FALSE(result);
    return result.error;
  };
  EXPECT_NE(errorOf([](auto& f) { f.width = 0; }).find("0x48"), std::string::npos);
  EXPECT_NE(errorOf([](auto& f) { f.height = -3; }).find("64x-3"), std::string::npos);
  EXPECT_NE(errorOf([](auto& f) { f.width = 100000; }).find("100000x48"), std::string::npos);
  EXPECT_NE(errorOf([](auto& f) { f.width = f.height = 8192; }).find("cannot hold"),
            std::string::npos);
  EXPECT_NE(errorOf([](auto& f) { f.width = 65; }).find("depth"), std::string::npos);
  EXPECT_NE(errorOf([](auto& f) { f.height = 47; }).find("depth"), std::string::npos);
  EXPECT_NE(errorOf([](auto& f) { f.depth.resize(f.depth.size() / 2); }).find("truncated"),
            std::string::npos);
  EXPECT_NE(errorOf([](auto& f) { f.depth.clear(); }).find("depth"), std::string::npos);
  EXPECT_NE(errorOf([](auto& f) { f.depth.assign(100, 7); }).find("damaged, truncated"),
            std::string::npos);
  EXPECT_NE(errorOf([](auto& f) { f.colour.clear(); }).find("colour"), std::string::npos);
  EXPECT_NE(
      errorOf([](auto& f) { f.colour.resize(f.colour.size() * 9 / 10); }).find("damaged JPEG"),
      std::string::npos);
  EXPECT_NE(errorOf([](auto& f) { f.colour.assign(500, 3); }).find("not a JPEG"),
            std::string::npos);
  EXPECT_NE(errorOf([](auto& f) { f.colour_format = ColourFormat::kRgb; }).find("raw pixels"),
            std::string::npos);
  EncodedFrame other = good;
  other.colour = encode(makeFrame(32, 48, 5)).colour;
  EXPECT_NE(decode(other).error.find("JPEG image is 32x48"), std::string::npos);
}

TEST(Codec, RandomBytesNeverCrash) {
  std::mt19937_64 random(9);
  const EncodedFrame good = encode(makeFrame(64, 48, 6));
  for (int i = 0; i < 300; ++i) {
    EncodedFrame bad = good;
    for (int k = 0; k < 5; ++k) {
      bad.colour[random() % bad.colour.size()] = static_cast<std::uint8_t>(random());
      bad.depth[random() % bad.depth.size()] = static_cast<std::uint8_t>(random());
    }
    const auto result = decode(bad);
    EXPECT_EQ(static_cast<bool>(result), result.error.empty());
  }
}

TEST(Codec, EncodeThrowsOnUnequalPlanes) {
  RgbdFrame frame = makeFrame(64, 48, 7);
  frame.colour = Image<Rgb>(32, 48);
  EXPECT_THROW(encode(frame), std::invalid_argument);
  EXPECT_THROW(encode(RgbdFrame{}), std::invalid_argument);
}

}  // namespace
}  // namespace rf
