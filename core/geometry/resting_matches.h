// Matches that stay where they are in the image while the rest of it moves.
//
// What is fixed to the camera (a bonnet, a chassis, a hand) is seen at one place whatever the
// camera does. Its matches agree with every motion that does not turn, and win a start of a map for
// the wrong one. Far or fixated points may rest as well; but with those the displacements go from
// nothing to those of the others without a gap, so that nothing is taken out where there is none.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/two_view.h"

namespace vpslam {

struct RestingMatchesOptions {
  /// A match rests below so many standard deviations of its displacement ...
  double max_resting_sigmas = 1.5;
  /// ... and moves above so many.
  double min_moving_sigmas = 4;
  /// There is something at rest only if it has this share of the image, ...
  double min_resting_share = 0.05;
  /// ... if this share moves, ...
  double min_moving_share = 0.5;
  /// ... and if what lies in between is at most so many times what rests.
  double max_between = 0.5;

  template <class V>
  void Visit(V& v) {
    v("max_resting_sigmas", max_resting_sigmas);
    v("min_moving_sigmas", min_moving_sigmas);
    v("min_resting_share", min_resting_share);
    v("min_moving_share", min_moving_share);
    v("max_between", max_between);
  }
  std::optional<std::string> Validate() const;
};

/// Per match, whether it shows something that is fixed to the camera: if there is such a thing, all
/// that do not move.
std::vector<bool> RestingMatches(std::span<const TwoViewMatch> matches,
                                 const RestingMatchesOptions& options);

}  // namespace vpslam
