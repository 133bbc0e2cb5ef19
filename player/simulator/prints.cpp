#include "player/simulator/prints.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "player/simulator/noise_image.h"

namespace vpslam::simulator {
namespace {

/// Grey levels as a printer sees them: gamma-coded, 0 to 255.
using Canvas = cv::Mat1b;

cv::Mat1f ToReflectance(const Canvas& canvas) {
  cv::Mat1f image(canvas.size());
  std::transform(canvas.begin(), canvas.end(), image.begin(), [](uint8_t grey) {
    return static_cast<float>(0.02 + 0.86 * std::pow(grey / 255.0, 2.2));
  });
  return image;
}

/// Print is not perfectly even: faint wear and grain.
cv::Mat1f Worn(const Canvas& canvas, Random& random) {
  cv::Mat1f image = ToReflectance(canvas);
  image = image.mul(1 + 0.05 * FractalNoise(canvas.size(), 3, 3, 4, 0.6, random.Next()));
  return image;
}

std::string Word(Random& random) {
  static const char* const kSyllables[] = {"ka",  "lo", "mer", "ti",  "sun", "ra",  "vel",
                                           "no",  "an", "der", "qui", "po",  "est", "bri",
                                           "gam", "fe", "xu",  "hol", "min", "stra"};
  std::string word;
  const int syllables = 1 + random.Below(3);
  for (int i = 0; i < syllables; ++i) word += kSyllables[random.Below(std::size(kSyllables))];
  return word;
}

constexpr int kFonts[] = {cv::FONT_HERSHEY_SIMPLEX, cv::FONT_HERSHEY_DUPLEX,
                          cv::FONT_HERSHEY_COMPLEX, cv::FONT_HERSHEY_TRIPLEX};

/// Writes a word so that it fills at most `box`, left-aligned.
void Write(Canvas& canvas, std::string text, const cv::Rect& box, int grey, bool bold,
           Random& random) {
  const int font = kFonts[random.Below(std::size(kFonts))];
  if (random.Chance(0.5)) {
    for (char& c : text) c = static_cast<char>(std::toupper(c));
  }
  int baseline = 0;
  const cv::Size unit = cv::getTextSize(text, font, 1, 1, &baseline);
  const double scale = std::min(static_cast<double>(box.width) / unit.width,
                                static_cast<double>(box.height) / (unit.height + 0.4 * baseline));
  const int thickness = std::max(1, static_cast<int>(std::lround(scale * (bold ? 3.2 : 1.4))));
  cv::putText(canvas, text, {box.x, box.y + static_cast<int>(scale * (unit.height + 2))}, font,
              scale, grey, thickness, cv::LINE_AA);
}

/// Lines of small words, as text looks from a distance at which it can't be read.
void Paragraph(Canvas& canvas, const cv::Rect& box, int line_height, int grey, Random& random) {
  for (int y = box.y; y + line_height <= box.y + box.height; y += line_height) {
    int x = box.x + (random.Chance(0.15) ? line_height : 0);
    const int right =
        box.x + static_cast<int>(box.width * (random.Chance(0.2) ? random.Uniform(0.3, 0.8)
                                                                 : random.Uniform(0.9, 1.0)));
    while (x < right) {
      const std::string word = Word(random);
      const double scale = line_height / 34.0;
      int baseline = 0;
      const int width = cv::getTextSize(word, cv::FONT_HERSHEY_SIMPLEX, scale, 1, &baseline).width;
      if (x + width > box.x + box.width) break;
      cv::putText(canvas, word, {x, y + static_cast<int>(0.75 * line_height)},
                  cv::FONT_HERSHEY_SIMPLEX, scale, grey, 1, cv::LINE_AA);
      x += width + line_height / 2;
    }
  }
}

/// A picture that could be a photograph: soft fields and a few hard shapes.
void Picture(Canvas& canvas, const cv::Rect& box, Random& random) {
  Canvas part = canvas(box);
  const cv::Mat1f soft =
      FractalNoise(box.size(), 2 + random.Below(3), 2 + random.Below(3), 5, 0.55, random.Next());
  const double mean = random.Uniform(70, 180), contrast = random.Uniform(80, 160);
  for (int y = 0; y < part.rows; ++y) {
    for (int x = 0; x < part.cols; ++x) {
      part(y, x) = cv::saturate_cast<uint8_t>(mean + contrast * soft(y, x));
    }
  }
  const int shapes = 3 + random.Below(8);
  const double size = std::min(box.width, box.height);
  for (int i = 0; i < shapes; ++i) {
    const cv::Point centre(random.Below(box.width), random.Below(box.height));
    const int grey = random.Below(256);
    const int radius = std::max(2, static_cast<int>(size * random.Uniform(0.05, 0.28)));
    switch (random.Below(4)) {
      case 0:
        cv::circle(part, centre, radius, grey, random.Chance(0.6) ? cv::FILLED : 1 + radius / 6,
                   cv::LINE_AA);
        break;
      case 1:
        cv::ellipse(part, centre, {radius, 1 + radius / 3}, random.Uniform(0, 180), 0, 360, grey,
                    cv::FILLED, cv::LINE_AA);
        break;
      case 2: {
        std::vector<cv::Point> corners;
        for (int k = 0; k < 3 + random.Below(3); ++k) {
          const double angle = random.Uniform(0, 6.2832);
          corners.emplace_back(centre.x + static_cast<int>(radius * std::cos(angle)),
                               centre.y + static_cast<int>(radius * std::sin(angle)));
        }
        cv::fillPoly(part, std::vector<std::vector<cv::Point>>{corners}, grey, cv::LINE_AA);
        break;
      }
      default:
        cv::line(part, centre,
                 {centre.x + random.Below(2 * radius) - radius,
                  centre.y + random.Below(2 * radius) - radius},
                 grey, 1 + radius / 10, cv::LINE_AA);
    }
  }
}

}  // namespace

cv::Mat1f Poster(cv::Size size, Random& random) {
  const int paper = 60 + random.Below(180);
  const int ink = paper > 140 ? random.Below(70) : 190 + random.Below(60);
  Canvas canvas(size, static_cast<uint8_t>(paper));
  const int margin = size.width / 14;
  const int width = size.width - 2 * margin;
  const int title = size.height / 8;
  const bool title_first = random.Chance(0.6);
  const int picture_height = static_cast<int>(size.height * random.Uniform(0.4, 0.58));
  int y = margin;
  const auto write_title = [&] {
    Write(canvas, Word(random) + " " + Word(random), {margin, y, width, title}, ink, true, random);
    y += title + margin / 2;
  };
  if (title_first) write_title();
  Picture(canvas, {margin, y, width, picture_height}, random);
  y += picture_height + margin / 2;
  if (!title_first) write_title();
  Paragraph(canvas, {margin, y, width, std::max(0, size.height - margin - y)},
            std::max(9, size.height / 34), ink, random);
  return Worn(canvas, random);
}

cv::Mat1f Painting(cv::Size size, Random& random) {
  Canvas canvas(size);
  const cv::Mat1f clouds = FractalNoise(size, 3, 5, 5, 0.6, random.Next());
  const cv::Mat1f strokes = FractalNoise(size, 60, 25, 2, 0.7, random.Next());
  const double sky = random.Uniform(130, 220);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      canvas(y, x) = cv::saturate_cast<uint8_t>(sky + 40.0 * y / size.height + 45 * clouds(y, x) +
                                                12 * strokes(y, x));
    }
  }
  const int ranges = 3 + random.Below(3);
  for (int i = 0; i < ranges; ++i) {
    const double horizon = size.height * (0.35 + 0.5 * i / ranges);
    const cv::Mat1f ridge = FractalNoise({size.width, 1}, 3 + i, 1, 5, 0.5, random.Next());
    const double grey = random.Uniform(30, 170);
    for (int x = 0; x < size.width; ++x) {
      const int top =
          std::clamp(static_cast<int>(horizon + 0.16 * size.height * ridge(0, x)), 0, size.height);
      for (int y = top; y < size.height; ++y) {
        canvas(y, x) = cv::saturate_cast<uint8_t>(grey + 30 * clouds(size.height - 1 - y, x) +
                                                  28 * strokes(y, x) + 0.1 * (y - top));
      }
    }
  }
  const int trees = 4 + random.Below(14);
  for (int i = 0; i < trees; ++i) {
    const int x = random.Below(size.width);
    const int foot = static_cast<int>(size.height * random.Uniform(0.55, 0.98));
    const int height = static_cast<int>(size.height * random.Uniform(0.08, 0.3));
    const int grey = random.Below(90);
    cv::line(canvas, {x, foot}, {x, foot - height / 2}, grey, 2, cv::LINE_AA);
    cv::ellipse(canvas, {x, foot - 2 * height / 3}, {height / 4, height / 3}, 0, 0, 360, grey + 25,
                cv::FILLED, cv::LINE_AA);
  }
  return Worn(canvas, random);
}

cv::Mat1f Sheet(cv::Size size, Random& random) {
  Canvas canvas(size, static_cast<uint8_t>(225 + random.Below(30)));
  const int margin = size.width / 9;
  const int width = size.width - 2 * margin;
  const int line = std::max(8, size.height / 40);
  Write(canvas, Word(random) + " " + Word(random), {margin, margin, width, 2 * line}, 30, true,
        random);
  int y = margin + 3 * line;
  while (y < size.height - margin - 4 * line) {
    const int height = std::min(size.height - margin - y, line * (4 + random.Below(9)));
    switch (random.Below(4)) {
      case 0:
        Picture(canvas, {margin, y, width, height}, random);
        break;
      case 1:
        for (int i = 0; i <= 4; ++i) {
          cv::line(canvas, {margin, y + i * (height - 1) / 4},
                   {margin + width, y + i * (height - 1) / 4}, 60, 1, cv::LINE_AA);
          cv::line(canvas, {margin + i * width / 4, y}, {margin + i * width / 4, y + height - 1},
                   60, 1, cv::LINE_AA);
        }
        Paragraph(canvas, {margin + 4, y, width - 4, height}, std::max(8, height / 4), 50, random);
        break;
      default:
        Paragraph(canvas, {margin, y, width, height}, line, 50, random);
    }
    y += height + line;
  }
  return Worn(canvas, random);
}

cv::Mat1f Cover(cv::Size size, Random& random) {
  const int paper = 25 + random.Below(225);
  const int ink = paper > 130 ? random.Below(60) : 205 + random.Below(50);
  Canvas canvas(size, static_cast<uint8_t>(paper));
  const int margin = size.width / 12;
  const int width = size.width - 2 * margin;
  Write(canvas, Word(random), {margin, margin, width, size.height / 6}, ink, true, random);
  const int y = margin + size.height / 5;
  const int height = static_cast<int>(size.height * random.Uniform(0.3, 0.55));
  Picture(canvas, {margin, y, width, height}, random);
  Paragraph(canvas, {margin, y + height + margin, width, size.height - y - height - 2 * margin},
            std::max(10, size.height / 20), ink, random);
  return Worn(canvas, random);
}

cv::Mat1f Spine(cv::Size size, Random& random) {
  // Painted lying down, then turned, as titles run along the back.
  const cv::Size lying(size.height, size.width);
  const int paper = 20 + random.Below(220);
  const int ink = paper > 125 ? random.Below(60) : 195 + random.Below(60);
  Canvas canvas(lying, static_cast<uint8_t>(paper));
  const int bands = random.Below(4);
  for (int i = 0; i < bands; ++i) {
    const int x = random.Below(lying.width), width = 2 + random.Below(lying.width / 14);
    cv::rectangle(canvas, {x, 0, width, lying.height}, random.Below(256), cv::FILLED);
  }
  const int start = lying.width / 8 + random.Below(lying.width / 8);
  const int thick = std::max(6, static_cast<int>(lying.height * random.Uniform(0.4, 0.75)));
  Write(canvas, Word(random) + " " + Word(random),
        {start, (lying.height - thick) / 2, static_cast<int>(lying.width * 0.55), thick}, ink, true,
        random);
  if (random.Chance(0.6)) {
    cv::circle(canvas, {lying.width * 9 / 10, lying.height / 2}, std::max(2, lying.height / 4), ink,
               random.Chance(0.5) ? cv::FILLED : 2, cv::LINE_AA);
  }
  // The back is rounded: darker towards both long sides.
  for (int y = 0; y < lying.height; ++y) {
    const double from_middle = std::abs(2.0 * (y + 0.5) / lying.height - 1);
    canvas.row(y) *= 1 - 0.35 * std::pow(from_middle, 4);
  }
  cv::rotate(canvas, canvas, cv::ROTATE_90_CLOCKWISE);
  return Worn(canvas, random);
}

cv::Mat1f Calendar(cv::Size size, Random& random) {
  Canvas canvas(size, static_cast<uint8_t>(235));
  const int margin = size.width / 16;
  const int picture = size.height / 2;
  Picture(canvas, {0, 0, size.width, picture}, random);
  Write(canvas, Word(random), {margin, picture + margin / 2, size.width / 2, size.height / 14}, 40,
        true, random);
  const int top = picture + margin + size.height / 12;
  const int cell_x = (size.width - 2 * margin) / 7, cell_y = (size.height - top - margin) / 5;
  for (int i = 0; i < 31; ++i) {
    const cv::Rect cell(margin + i % 7 * cell_x, top + i / 7 * cell_y, cell_x, cell_y);
    cv::rectangle(canvas, cell, 150, 1);
    Write(canvas, std::to_string(i + 1),
          {cell.x + 3, cell.y + 3, cell_x / 2, std::max(6, cell_y / 2)}, i % 7 > 4 ? 120 : 40,
          false, random);
  }
  return Worn(canvas, random);
}

cv::Mat1f DoorPlate(cv::Size size, int number, Random& random) {
  Canvas canvas(size, static_cast<uint8_t>(215));
  cv::rectangle(canvas, {0, 0, size.width, size.height}, 110, 3);
  Write(canvas, std::to_string(number),
        {size.width / 12, size.height / 8, size.width / 2, size.height * 2 / 5}, 30, true, random);
  Paragraph(canvas,
            {size.width / 12, size.height * 3 / 5, size.width * 5 / 6, size.height * 2 / 5 - 6},
            std::max(9, size.height / 6), 60, random);
  return Worn(canvas, random);
}

cv::Mat1f NoticeBoard(cv::Size size, Random& random) {
  cv::Mat1f board(size, 0.24f);
  board += 0.05 * WhiteNoise(size, random.Next());
  board += 0.03 * FractalNoise(size, 40, 40, 3, 0.7, random.Next());
  const int sheets = 5 + random.Below(5);
  for (int i = 0; i < sheets; ++i) {
    const int width = static_cast<int>(size.height * random.Uniform(0.16, 0.34));
    const int height = static_cast<int>(width * random.Uniform(0.7, 1.42));
    const cv::Mat1f sheet = random.Chance(0.6)   ? Sheet({width, height}, random)
                            : random.Chance(0.5) ? Cover({width, height}, random)
                                                 : Poster({width, height}, random);
    const double angle = random.Uniform(-6, 6);
    const double x = random.Uniform(0.05, 0.95) * (size.width - width);
    const double y = random.Uniform(0.03, 0.97) * (size.height - height);
    cv::Mat move = cv::getRotationMatrix2D(cv::Point2f(width / 2.0f, height / 2.0f), angle, 1);
    move.at<double>(0, 2) += x;
    move.at<double>(1, 2) += y;
    cv::Mat1f mask, placed;
    cv::warpAffine(cv::Mat1f::ones(sheet.size()), mask, move, size);
    cv::warpAffine(sheet, placed, move, size);
    board = board.mul(1 - mask) + placed;
    cv::circle(board, {static_cast<int>(x + width / 2.0), static_cast<int>(y + 0.06 * height)}, 4,
               random.Uniform(0.05, 0.4), cv::FILLED, cv::LINE_AA);
  }
  return cv::max(board, 0.02);
}

cv::Mat1f WindowView(cv::Size size, Random& random) {
  cv::Mat1f image(size);
  const cv::Mat1f clouds = FractalNoise(size, 3, 4, 4, 0.55, random.Next());
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      image(y, x) = 1.0f - 0.15f * static_cast<float>(y) / size.height + 0.12f * clouds(y, x);
    }
  }
  int x = -random.Below(40);
  while (x < size.width) {
    const int width = static_cast<int>(size.width * random.Uniform(0.12, 0.3));
    const int height = static_cast<int>(size.height * random.Uniform(0.2, 0.55));
    const double wall = random.Uniform(0.15, 0.5);
    cv::rectangle(image, {x, size.height - height, width, height}, wall, cv::FILLED);
    const int columns = 3 + random.Below(4), rows = 3 + random.Below(5);
    for (int i = 0; i < columns * rows; ++i) {
      const int cell_x = width / columns, cell_y = height / rows;
      cv::rectangle(
          image,
          {x + i % columns * cell_x + cell_x / 4,
           size.height - height + i / columns * cell_y + cell_y / 4, cell_x / 2, cell_y / 2},
          wall * random.Uniform(0.4, 1.6), cv::FILLED);
    }
    x += width + random.Below(30);
  }
  return image;
}

cv::Mat1f Screen(cv::Size size, Random& random) {
  Canvas canvas(size, static_cast<uint8_t>(70));
  for (int i = 0; i < 3; ++i) {
    const int width = static_cast<int>(size.width * random.Uniform(0.35, 0.6));
    const int height = static_cast<int>(size.height * random.Uniform(0.4, 0.7));
    const cv::Rect box(random.Below(size.width - width), random.Below(size.height - height), width,
                       height);
    cv::rectangle(canvas, box, random.Chance(0.5) ? 235 : 35, cv::FILLED);
    cv::rectangle(canvas, {box.x, box.y, box.width, 14}, 130, cv::FILLED);
    Paragraph(canvas, {box.x + 8, box.y + 20, width - 16, height - 26}, 14,
              canvas(box.y + 30, box.x + 2) > 128 ? 50 : 210, random);
  }
  return ToReflectance(canvas);
}

cv::Mat1f Keyboard(cv::Size size, Random& random) {
  Canvas canvas(size, static_cast<uint8_t>(40));
  const double pitch = size.width / 15.5;
  for (int row = 0; row < 5; ++row) {
    double x = 0.25 * pitch;
    while (x < size.width - 1.1 * pitch) {
      const double width = row == 4 && x > 4 * pitch && x < 5 * pitch ? 5 * pitch
                           : x < pitch                                ? pitch * (1 + 0.25 * row)
                                                                      : pitch;
      const cv::Rect key(static_cast<int>(x), static_cast<int>(size.height * (0.06 + 0.18 * row)),
                         static_cast<int>(0.86 * width), static_cast<int>(0.155 * size.height));
      cv::rectangle(canvas, key, 85 + random.Below(20), cv::FILLED);
      Write(canvas, std::string(1, static_cast<char>('A' + random.Below(26))),
            {key.x + key.width / 4, key.y + 3, key.width / 3, key.height / 2}, 200, false, random);
      x += width;
    }
  }
  return Worn(canvas, random);
}

cv::Mat1f Parcel(cv::Size size, Random& random) {
  cv::Mat1f board(size, 0.30f);
  board += 0.02 * NoiseLayer(size, 90, 4, random.Next());
  board += 0.03 * FractalNoise(size, 4, 4, 4, 0.6, random.Next());
  const int tape = size.height / 9;
  cv::rectangle(board, {0, (size.height - tape) / 2, size.width, tape}, 0.4, cv::FILLED);
  if (random.Chance(0.8)) {
    const int width = size.width * 2 / 5, height = size.height / 3;
    const cv::Rect place(random.Below(size.width - width), random.Below(size.height - height),
                         width, height);
    Sheet({width, height}, random).copyTo(board(place));
  }
  Canvas stamp(size, static_cast<uint8_t>(0));
  Write(stamp, Word(random),
        {size.width / 12, size.height * 3 / 4, size.width / 3, size.height / 6}, 255, true, random);
  cv::arrowedLine(stamp, {size.width * 8 / 10, size.height * 9 / 10},
                  {size.width * 8 / 10, size.height * 7 / 10}, 255, 3, cv::LINE_AA, 0, 0.4);
  cv::Mat1f ink;
  stamp.convertTo(ink, CV_32F, 1 / 255.0);
  return board.mul(1 - 0.8 * ink);
}

cv::Mat1f Rug(cv::Size size, Random& random) {
  Canvas canvas(size, static_cast<uint8_t>(70 + random.Below(60)));
  const int border = size.height / 10;
  const int light = 150 + random.Below(80), dark = 20 + random.Below(40);
  cv::rectangle(canvas, {border / 2, border / 2, size.width - border, size.height - border}, light,
                border / 5);
  cv::rectangle(canvas, {border, border, size.width - 2 * border, size.height - 2 * border}, dark,
                border / 8);
  const int cell = size.height / 6;
  for (int y = border + cell / 2; y < size.height - border; y += cell) {
    for (int x = border + cell / 2; x < size.width - border; x += cell) {
      const double r = cell * random.Uniform(0.25, 0.42);
      const int corners = 4 + 2 * random.Below(3);
      std::vector<cv::Point> star;
      const double turn = random.Uniform(0, 3);
      for (int k = 0; k < 2 * corners; ++k) {
        const double radius = k % 2 == 0 ? r : r * 0.5;
        const double angle = turn + 3.14159265 * k / corners;
        star.emplace_back(x + static_cast<int>(radius * std::cos(angle)),
                          y + static_cast<int>(radius * std::sin(angle)));
      }
      cv::fillPoly(canvas, std::vector<std::vector<cv::Point>>{star},
                   random.Chance(0.5) ? light : dark, cv::LINE_AA);
      cv::circle(canvas, {x, y}, static_cast<int>(0.2 * r), random.Below(256), cv::FILLED,
                 cv::LINE_AA);
    }
  }
  cv::Mat1f image = ToReflectance(canvas);
  return image.mul(1 + 0.18 * WhiteNoise(size, random.Next()) +
                   0.1 * FractalNoise(size, 3, 3, 4, 0.6, random.Next()));
}

cv::Mat1f WallTiles(cv::Size size, int columns, int rows, Random& random) {
  Canvas canvas(size, static_cast<uint8_t>(120));  // the joints
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int x0 = column * size.width / columns + 1, y0 = row * size.height / rows + 1;
      const int x1 = (column + 1) * size.width / columns - 1;
      const int y1 = (row + 1) * size.height / rows - 1;
      const int grey = 175 + random.Below(40);
      cv::rectangle(canvas, {x0, y0, x1 - x0, y1 - y0}, grey, cv::FILLED);
      if (random.Chance(0.12)) {
        const cv::Point centre((x0 + x1) / 2, (y0 + y1) / 2);
        const int radius = (x1 - x0) / 3;
        for (int k = 0; k < 5; ++k) {
          const double angle = 1.2566 * k + random.Uniform(0, 0.6);
          cv::ellipse(canvas,
                      {centre.x + static_cast<int>(0.5 * radius * std::cos(angle)),
                       centre.y + static_cast<int>(0.5 * radius * std::sin(angle))},
                      {radius / 2, radius / 5}, angle * 57.3, 0, 360, 60 + random.Below(60),
                      cv::FILLED, cv::LINE_AA);
        }
      }
    }
  }
  return Worn(canvas, random);
}

}  // namespace vpslam::simulator
