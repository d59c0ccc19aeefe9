// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/paint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>

#include <opencv2/imgproc.hpp>

#include "simulation/noise.hpp"

namespace rf::sim {
namespace {

cv::Scalar scalar(Rgb c) { return {double(c.r), double(c.g), double(c.b)}; }

cv::Mat canvas(int width, int height, Rgb c) { return {height, width, CV_8UC3, scalar(c)}; }

Image<Rgb> toImage(const cv::Mat& mat) {
  Image<Rgb> out(mat.cols, mat.rows);
  for (int v = 0; v < mat.rows; ++v) {
    for (int u = 0; u < mat.cols; ++u) {
      const auto& c = mat.at<cv::Vec3b>(v, u);
      out(u, v) = {c[0], c[1], c[2]};
    }
  }
  return out;
}

std::uint8_t clip(double x) { return static_cast<std::uint8_t>(std::clamp(x, 0.0, 255.0)); }

/// Multiplies every texel by gain(u, v) and adds a little grain.
void modulate(cv::Mat& mat, Random& random, double grain,
              const std::function<double(double, double)>& gain) {
  for (int v = 0; v < mat.rows; ++v) {
    for (int u = 0; u < mat.cols; ++u) {
      const double g = gain(u, v) + grain * static_cast<double>(normalFromBits(random.bits()));
      auto& c = mat.at<cv::Vec3b>(v, u);
      for (int i = 0; i < 3; ++i) c[i] = clip(c[i] * g);
    }
  }
}

std::string word(Random& random, int letters) {
  static const std::string kVowels = "aeiou";
  static const std::string kConsonants = "bcdfghklmnprstvw";
  std::string out;
  for (int i = 0; i < letters; ++i) {
    const std::string& set = i % 2 == 0 ? kConsonants : kVowels;
    out += set[static_cast<std::size_t>(random.below(static_cast<int>(set.size())))];
  }
  return out;
}

/// Text lines that fill a rectangle.
void paragraph(cv::Mat& mat, Random& random, cv::Rect area, double scale, Rgb ink) {
  const int step = std::max(6, static_cast<int>(26 * scale));
  for (int v = area.y + step; v < area.y + area.height; v += step) {
    std::string line;
    const auto width = static_cast<std::size_t>(area.width / (15.0 * scale));
    const std::size_t stop = random.chance(0.2) ? width / 2 : width;
    while (line.size() < stop) line += word(random, 2 + random.below(8)) + " ";
    line.resize(std::min(line.size(), stop));
    cv::putText(mat, line, {area.x, v}, cv::FONT_HERSHEY_SIMPLEX, scale, scalar(ink),
                scale > 0.6 ? 2 : 1, cv::LINE_AA);
  }
}

void headline(cv::Mat& mat, Random& random, cv::Point at, double scale, Rgb ink) {
  std::string text = word(random, 4 + random.below(5));
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return char(c - 'a' + 'A'); });
  cv::putText(mat, text, at,
              random.chance(0.5) ? cv::FONT_HERSHEY_DUPLEX : cv::FONT_HERSHEY_TRIPLEX, scale,
              scalar(ink), std::max(1, static_cast<int>(2.5 * scale)), cv::LINE_AA);
}

/// Something like a photograph: a sky, hills and blobs.
void photograph(cv::Mat& mat, Random& random, cv::Rect area) {
  const Rgb top = randomColour(random, 100, 240, 0.6);
  const Rgb low = randomColour(random, 20, 160, 0.7);
  const Fractal noise(random.bits());
  const double horizon = random.uniform(0.35, 0.65);
  for (int v = 0; v < area.height; ++v) {
    for (int u = 0; u < area.width; ++u) {
      const double x = 3.0 * u / area.width;
      const double y = 3.0 * v / area.width;
      const bool sky = v < area.height * (horizon + 0.25 * (noise.at(x, 7.3, 4) - 0.5));
      const Rgb base = sky ? top : low;
      const double g = 0.5 + noise.at(2 * x, 2 * y, 5) * (sky ? 0.7 : 1.3);
      mat.at<cv::Vec3b>(area.y + v, area.x + u) = {clip(base.r * g), clip(base.g * g),
                                                   clip(base.b * g)};
    }
  }
}

void shapes(cv::Mat& mat, Random& random, int count) {
  for (int i = 0; i < count; ++i) {
    const cv::Point at{random.below(mat.cols), random.below(mat.rows)};
    const int size = std::max(4, random.below(mat.cols / 3));
    const cv::Scalar colour = scalar(randomColour(random, 20, 240, 0.9));
    switch (random.below(3)) {
      case 0:
        cv::circle(mat, at, size / 2, colour, random.chance(0.6) ? -1 : 6, cv::LINE_AA);
        break;
      case 1:
        cv::rectangle(mat, cv::Rect(at.x, at.y, size, size / 2 + 4), colour, -1);
        break;
      default:
        cv::ellipse(mat, at, {size / 2 + 2, size / 4 + 2}, random.uniform(0, 180), 0, 360, colour,
                    -1, cv::LINE_AA);
    }
  }
}

void barCode(cv::Mat& mat, Random& random, cv::Rect area) {
  cv::rectangle(mat, area, {245, 245, 245}, -1);
  for (int u = area.x + 4; u < area.x + area.width - 4;) {
    const int w = 1 + random.below(4);
    cv::rectangle(mat, cv::Rect(u, area.y + 3, w, area.height - 6), {20, 20, 20}, -1);
    u += w + 2 + random.below(4);
  }
}

}  // namespace

Rgb randomColour(Random& random, double low, double high, double saturation) {
  const double value = random.uniform(low, high);
  // Things in rooms are mostly muted, and rather red, brown, beige or blue than green or violet.
  const double u = random.uniform();
  const double s = saturation * (0.25 + 0.75 * u * u);
  const double pick = random.uniform();
  const double spread = random.uniform(-0.45, 0.45);
  const double hue = (pick < 0.5 ? 0.35 : pick < 0.8 ? 3.6 : pick < 0.92 ? 1.6 : 5.0) + spread;
  const auto channel = [&](double shift) {
    const double h = std::fmod(hue + shift + 6.0, 6.0);
    const double ramp = std::clamp(std::abs(h - 3.0) - 1.0, 0.0, 1.0);
    return clip(value * (1 - s * (1 - ramp)));
  };
  return {channel(0), channel(4), channel(2)};
}

Image<Rgb> paintPoster(Random& random, int width, int height) {
  const Rgb paper = randomColour(random, 40, 250, 0.7);
  const bool dark = paper.r + paper.g + paper.b < 330;
  const Rgb ink = dark ? randomColour(random, 200, 255, 0.4) : randomColour(random, 5, 80, 0.8);
  cv::Mat mat = canvas(width, height, paper);
  const int margin = width / 14;
  const int style = random.below(3);
  if (style == 0) {
    photograph(mat, random, {margin, margin, width - 2 * margin, height / 2});
  } else if (style == 1) {
    shapes(mat, random, 7 + random.below(10));
  } else {
    for (int i = 0; i < 4; ++i) {
      photograph(mat, random,
                 {margin + (i % 2) * (width / 2 - margin / 2), margin + (i / 2) * (height / 4),
                  width / 2 - 2 * margin, height / 4 - margin});
    }
  }
  headline(mat, random, {margin, height * 2 / 3}, width / 190.0, ink);
  paragraph(mat, random, {margin, height * 2 / 3 + 8, width - 2 * margin, height / 3 - 20},
            width / 900.0 + 0.12, ink);
  modulate(mat, random, 0.01, [](double, double) { return 1.0; });
  return toImage(mat);
}

Image<Rgb> paintPage(Random& random, int width, int height) {
  cv::Mat mat = canvas(width, height, {246, 245, 240});
  const int margin = width / 10;
  headline(mat, random, {margin, height / 8}, width / 330.0, {25, 25, 30});
  paragraph(mat, random, {margin, height / 7, width - 2 * margin, height / 3}, 0.33, {50, 50, 55});
  photograph(mat, random, {margin, height / 2, width / 2, height / 4});
  paragraph(mat, random, {margin, height * 3 / 4, width - 2 * margin, height / 5}, 0.33,
            {50, 50, 55});
  return toImage(mat);
}

Image<Rgb> paintCarton(Random& random, int width, int height) {
  const bool printed = random.chance(0.45);
  const Rgb base = printed ? randomColour(random, 110, 235, 0.6)
                           : Rgb{clip(random.uniform(165, 195)), clip(random.uniform(128, 150)),
                                 clip(random.uniform(88, 110))};
  const Rgb ink = printed ? randomColour(random, 10, 90, 0.9) : Rgb{70, 45, 30};
  cv::Mat mat = canvas(width, height, base);
  if (printed) shapes(mat, random, 5);
  if (printed && random.chance(0.7)) {
    photograph(mat, random, {width / 2, height / 5, width * 2 / 5, height / 2});
  }
  headline(mat, random, {width / 16, height / 4}, width / 260.0, ink);
  paragraph(mat, random, {width / 16, height / 3, width * 2 / 5, height / 3}, 0.4, ink);
  if (!printed) {  // packing tape and a freight label
    cv::rectangle(mat, cv::Rect(0, height / 2 - height / 24, width, height / 12),
                  scalar({clip(base.r * 0.86), clip(base.g * 0.84), clip(base.b * 0.72)}), -1);
    const cv::Rect label(width * 9 / 16, height / 8, width * 3 / 8, height * 5 / 16);
    cv::rectangle(mat, label, {240, 240, 235}, -1);
    paragraph(mat, random, {label.x + 8, label.y + 4, label.width - 16, label.height / 2}, 0.4,
              {30, 30, 30});
    barCode(mat, random,
            {label.x + 8, label.y + label.height * 5 / 8, label.width - 16, label.height / 3});
    for (int i = 0; i < 2; ++i) {
      cv::arrowedLine(mat, {width / 10 + i * width / 12, height * 15 / 16},
                      {width / 10 + i * width / 12, height * 11 / 16}, scalar(ink), 5, cv::LINE_AA,
                      0, 0.35);
    }
  } else {
    barCode(mat, random, {width / 16, height * 3 / 4, width / 4, height / 6});
  }
  const Fractal stain(random.bits());
  modulate(mat, random, 0.012, [&](double u, double v) {
    const double flute = printed ? 0.0 : 0.025 * std::sin(u * 0.9);
    const double edge = std::min({u, v, width - 1 - u, height - 1 - v}) < 4 ? -0.12 : 0.0;
    return 0.92 + 0.16 * stain.at(u / 70.0, v / 70.0, 3) + flute + edge;
  });
  return toImage(mat);
}

Image<Rgb> paintWood(Random& random, int width, int height, Rgb base) {
  cv::Mat mat = canvas(width, height, base);
  const Fractal grain(random.bits());
  const double tightness = random.uniform(30, 70);
  modulate(mat, random, 0.015, [&](double u, double v) {
    const double bend = 2.5 * grain.at(u / 300.0, v / 90.0, 3);
    const double ring = std::sin(v / tightness * 6.0 + bend * 6.0);
    const double fibre = grain.at(u / 90.0 + 50, v / 2.2, 3);
    return 0.80 + 0.045 * ring + 0.34 * fibre;
  });
  return toImage(mat);
}

Image<Rgb> paintPlaster(Random& random, int width, int height, Rgb base) {
  cv::Mat mat = canvas(width, height, base);
  const Fractal noise(random.bits());
  modulate(mat, random, 0.006, [&](double u, double v) {
    return 0.93 + 0.05 * noise.at(u / 4.0, v / 4.0, 3) + 0.09 * noise.at(u / 240.0, v / 240.0, 3);
  });
  for (int i = 0; i < 10; ++i) {  // scuffs, filled holes, pencil marks
    const cv::Point at{random.below(width), random.below(height)};
    const double shade = random.uniform(0.75, 0.92);
    const cv::Scalar colour = scalar(base) * shade;
    if (random.chance(0.5)) {
      cv::circle(mat, at, 1 + random.below(4), colour, -1, cv::LINE_AA);
    } else {
      cv::line(mat, at, {at.x + random.below(60) - 30, at.y + random.below(20) - 10}, colour, 1,
               cv::LINE_AA);
    }
  }
  return toImage(mat);
}

Image<Rgb> paintFloor(Random& random, int width, int height) {
  const int style = random.below(3);
  const Fractal noise(random.bits());
  if (style == 0) {  // carpet
    cv::Mat mat = canvas(width, height, randomColour(random, 70, 150, 0.35));
    modulate(mat, random, 0.10, [&](double u, double v) {
      return 0.75 + 0.3 * noise.at(u / 3.0, v / 3.0, 3) + 0.2 * noise.at(u / 150.0, v / 150.0, 3);
    });
    return toImage(mat);
  }
  const bool planks = style == 1;
  const Rgb base = planks ? Rgb{clip(random.uniform(140, 190)), clip(random.uniform(100, 135)),
                                clip(random.uniform(65, 95))}
                          : randomColour(random, 130, 215, 0.15);
  cv::Mat mat = canvas(width, height, base);
  const double row = planks ? 64 : 170;
  const double column = planks ? 420 : 170;
  const std::uint64_t seed = random.bits();
  modulate(mat, random, 0.012, [&](double u, double v) {
    const double r = std::floor(v / row);
    const double shift = planks ? 137.0 * r : 0.0;
    const double c = std::floor((u + shift) / column);
    const double du = u + shift - c * column;
    const double dv = v - r * row;
    const auto id = static_cast<std::uint64_t>(std::int64_t(r) * 1000 + std::int64_t(c));
    const double tone = unitFromBits(scramble(seed, id));
    const double joint = std::min(du, dv) < (planks ? 1.6 : 3.0) ? 0.6 : 1.0;
    const double fibre = planks ? noise.at(u / 60.0 + 31 * tone, v / 2.5, 3)
                                : noise.at(u / 25.0, v / 25.0 + 9 * tone, 4);
    return joint * (0.72 + 0.26 * tone + 0.25 * fibre);
  });
  return toImage(mat);
}

Image<Rgb> paintCloth(Random& random, int width, int height) {
  const Rgb base = randomColour(random, 50, 220, 0.7);
  const Rgb stripe = randomColour(random, 30, 240, 0.7);
  const bool checked = random.chance(0.5);
  const int period = 24 + random.below(50);
  cv::Mat mat = canvas(width, height, base);
  for (int u = 0; u < width; u += period) {
    cv::rectangle(mat, cv::Rect(u, 0, period / 3, height), scalar(stripe), -1);
  }
  if (checked) {
    cv::Mat across = mat.clone();
    for (int v = 0; v < height; v += period) {
      cv::rectangle(across, cv::Rect(0, v, width, period / 3), scalar(stripe), -1);
    }
    cv::addWeighted(mat, 0.5, across, 0.5, 0, mat);
  }
  const Fractal fold(random.bits());
  modulate(mat, random, 0.03, [&](double u, double v) {
    const double weave = 0.05 * ((int(u) / 2 + int(v) / 2) % 2);
    return 0.75 + 0.4 * fold.at(u / 80.0, v / 200.0, 3) + weave;
  });
  return toImage(mat);
}

Image<Rgb> paintBookSpine(Random& random, int width, int height) {
  const Rgb base = randomColour(random, 30, 230, 0.85);
  const bool dark = base.r + base.g + base.b < 360;
  const Rgb ink = dark ? Rgb{235, 225, 190} : Rgb{25, 20, 20};
  cv::Mat side = canvas(height, width, base);  // written lying, then turned
  headline(side, random, {height / 8, width * 3 / 4}, width / 46.0, ink);
  for (const int u : {height / 20, height - height / 20 - 3}) {
    cv::rectangle(side, cv::Rect(u, 0, 3, width), scalar(ink), -1);
  }
  cv::Mat mat;
  cv::rotate(side, mat, cv::ROTATE_90_CLOCKWISE);
  modulate(mat, random, 0.015,
           [&](double u, double) { return 0.8 + 0.25 * std::sin(3.14159 * (u + 0.5) / width); });
  return toImage(mat);
}

Image<Rgb> paintScreen(Random& random, int width, int height) {
  cv::Mat mat = canvas(width, height, randomColour(random, 30, 110, 0.6));
  for (int i = 0; i < 3; ++i) {
    const cv::Rect area(random.below(width / 3), random.below(height / 3), width / 2, height / 2);
    cv::rectangle(mat, area, {235, 235, 235}, -1);
    cv::rectangle(mat, cv::Rect(area.x, area.y, area.width, 14), {70, 90, 140}, -1);
    paragraph(mat, random, {area.x + 8, area.y + 16, area.width - 16, area.height - 24}, 0.33,
              {40, 40, 40});
  }
  return toImage(mat);
}

Image<Rgb> paintKeyboard(Random& random, int width, int height) {
  const bool dark = random.chance(0.7);
  const Rgb body = dark ? Rgb{35, 35, 38} : Rgb{205, 200, 190};
  const Rgb key = dark ? Rgb{55, 55, 60} : Rgb{228, 225, 215};
  cv::Mat mat = canvas(width, height, body);
  const int rows = 5;
  const int columns = 16;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const cv::Rect area(6 + c * (width - 12) / columns, 6 + r * (height - 12) / rows,
                          (width - 12) / columns - 3, (height - 12) / rows - 3);
      cv::rectangle(mat, area, scalar(key), -1);
      cv::putText(mat, word(random, 1), {area.x + 4, area.y + area.height - 6},
                  cv::FONT_HERSHEY_SIMPLEX, 0.4,
                  dark ? cv::Scalar(220, 220, 220) : cv::Scalar(30, 30, 30), 1, cv::LINE_AA);
    }
  }
  return toImage(mat);
}

Image<Rgb> paintLeaves(Random& random, int width, int height) {
  cv::Mat mat = canvas(width, height, {25, 40, 18});
  for (int i = 0; i < 260; ++i) {
    const double shade = random.uniform(0.5, 1.4);
    const cv::Scalar colour(45 * shade, 95 * shade, 35 * shade);
    cv::ellipse(mat, {random.below(width), random.below(height)},
                {10 + random.below(26), 4 + random.below(8)}, random.uniform(0, 180), 0, 360,
                colour, -1, cv::LINE_AA);
  }
  return toImage(mat);
}

Image<Rgb> paintWhiteboard(Random& random, int width, int height) {
  cv::Mat mat = canvas(width, height, {238, 240, 240});
  const std::array<Rgb, 4> pens = {Rgb{20, 20, 30}, Rgb{30, 60, 160}, Rgb{180, 30, 30},
                                   Rgb{20, 120, 60}};
  const auto pen = [&] { return pens[static_cast<std::size_t>(random.below(4))]; };
  for (int i = 0; i < 5; ++i) {
    const cv::Point at{random.below(width * 2 / 3), random.below(height * 3 / 4) + height / 8};
    paragraph(mat, random, {at.x, at.y, width / 3, height / 6}, 0.7, pen());
  }
  for (int i = 0; i < 6; ++i) {
    const cv::Point a{random.below(width), random.below(height)};
    const cv::Point b{random.below(width), random.below(height)};
    if (random.chance(0.5)) {
      cv::arrowedLine(mat, a, b, scalar(pen()), 3, cv::LINE_AA, 0, 0.05);
    } else {
      cv::rectangle(mat, cv::Rect(a.x, a.y, width / 6, height / 7), scalar(pen()), 3, cv::LINE_AA);
    }
  }
  return toImage(mat);
}

}  // namespace rf::sim
