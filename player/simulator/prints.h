// Things with a face of their own: posters, paintings, book spines, sheets of text, signs, what is
// seen through a window. Reflectance images; `size` is in texels.
#pragma once

#include <opencv2/core.hpp>

#include "player/simulator/random.h"

namespace vpslam::simulator {

/// A poster with a title, a picture made of overlapping shapes and lines of text.
cv::Mat1f Poster(cv::Size size, Random& random);
/// A landscape: sky, hills, water or trees, in broad strokes.
cv::Mat1f Painting(cv::Size size, Random& random);
/// White paper with paragraphs, sometimes a table or a diagram.
cv::Mat1f Sheet(cv::Size size, Random& random);
/// Front of a book or magazine.
cv::Mat1f Cover(cv::Size size, Random& random);
/// Back of a book, title along its height.
cv::Mat1f Spine(cv::Size size, Random& random);
/// A month: title and a grid of days.
cv::Mat1f Calendar(cv::Size size, Random& random);
/// Door plate with a number.
cv::Mat1f DoorPlate(cv::Size size, int number, Random& random);
/// Cork with pinned sheets and notes.
cv::Mat1f NoticeBoard(cv::Size size, Random& random);
/// Houses under a bright sky.
cv::Mat1f WindowView(cv::Size size, Random& random);
/// Screen with open windows.
cv::Mat1f Screen(cv::Size size, Random& random);
/// Keys in staggered rows.
cv::Mat1f Keyboard(cv::Size size, Random& random);
/// Side of a parcel: tape, label, stamps.
cv::Mat1f Parcel(cv::Size size, Random& random);
/// Woven rug: border and repeated, slightly irregular ornaments.
cv::Mat1f Rug(cv::Size size, Random& random);
/// Glazed wall tiles, `columns` x `rows`, some with a motif.
cv::Mat1f WallTiles(cv::Size size, int columns, int rows, Random& random);

}  // namespace vpslam::simulator
