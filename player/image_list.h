// What the reader of a data-set layout finds, and what is checked of it before it is played.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "player/truth_track.h"

namespace vpslam {

struct ListedImage {
  int64_t stamp_us = 0;
  std::string path;
  int64_t line = 0;  ///< of the list's file; 0 where there is none
};

struct ImageList {
  std::string name;         ///< the list's file, or the folder, for messages
  std::string line_form;    ///< what a line of that file looks like, for messages
  std::string camera_name;  ///< the calibration's file, for messages
  Camera camera;
  std::vector<ListedImage> images;  ///< in the order of the file
  TruthTrack truth;
  std::string truth_name;  ///< its file; empty where there is none

  /// What one step of the list's numbers is called, and how long it is. Empty where the stamps are
  /// no times that somebody wrote, and then they are not judged.
  std::string unit = "seconds";
  double unit_us = 1e6;
  double rate_hz = 0;  ///< that the data set is known for; 0: the calibration's

  std::map<std::string, int64_t> skipped;  ///< images that will not be played, by reason
  std::string first_skipped;               ///< "FILE:7: what is wrong", for messages
  std::vector<std::string> notes;          ///< see SourceReport

  /// Where the clock was set back: images from this time on, as played, have their truth so much
  /// earlier.
  int64_t bridged_from_us = 0, bridged_by_us = 0;

  int64_t num_skipped() const;
  int64_t total() const { return static_cast<int64_t>(images.size()) + num_skipped(); }
  void Skip(const std::string& reason, const std::string& what);
  /// The list's line of an image, or its file where it has none.
  std::string Place(const ListedImage& image) const;
};

/// Brings the images in order of time, see time_order.h, and takes out those that have no place in
/// it. Throws std::runtime_error if the clock was set back more than once.
void PutInOrderOfTime(ImageList* list);

/// Takes out images whose files do not exist.
void LeaveOutMissingFiles(ImageList* list);

/// Throws std::runtime_error if the steps of time are not those of a camera, naming the unit that
/// the numbers are in; or if the names are those of several series. For a list in order of time.
void RequireOneCamera(const ImageList& list);

/// Throws std::runtime_error if there is no image, and with the first of those that are skipped if
/// these are more than a source may lose (BadFrameOptions).
void RequireMost(const ImageList& list);

/// One line on images without a true pose; empty if most have one, or there is no file.
std::string DescribeTruth(const ImageList& list);

}  // namespace vpslam
