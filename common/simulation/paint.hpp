// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry/image.hpp"
#include "simulation/random.hpp"

namespace rf::sim {

/// Pictures for the world's surfaces, painted from random numbers: the same state of `random` gives
/// the same picture. Values are as displayed (sRGB). Sizes are texels.

/// Advertisement or art print: blocks of colour, shapes, photographs of a sort, headlines, text.
Image<Rgb> paintPoster(Random& random, int width, int height);
/// A sheet with headings, paragraphs and a figure.
Image<Rgb> paintPage(Random& random, int width, int height);
/// Side of a cardboard or printed carton with tape, label, bar code, arrows.
Image<Rgb> paintCarton(Random& random, int width, int height);
/// Wood with grain along u.
Image<Rgb> paintWood(Random& random, int width, int height, Rgb base);
/// Painted wall with roller texture, marks and slow stains.
Image<Rgb> paintPlaster(Random& random, int width, int height, Rgb base);
/// Parquet, tiles or carpet; repeats mirrored.
Image<Rgb> paintFloor(Random& random, int width, int height);
/// Woven cloth with stripes or checks.
Image<Rgb> paintCloth(Random& random, int width, int height);
/// Back of a book with its title.
Image<Rgb> paintBookSpine(Random& random, int width, int height);
/// A monitor's picture: windows with text.
Image<Rgb> paintScreen(Random& random, int width, int height);
/// A keyboard from above.
Image<Rgb> paintKeyboard(Random& random, int width, int height);
/// Leaves of a plant.
Image<Rgb> paintLeaves(Random& random, int width, int height);
/// A whiteboard with pen strokes.
Image<Rgb> paintWhiteboard(Random& random, int width, int height);

/// A colour of given brightness range (0..255) and at most the given saturation (0..1).
Rgb randomColour(Random& random, double low, double high, double saturation);

}  // namespace rf::sim
