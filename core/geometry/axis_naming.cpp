#include "core/geometry/axis_naming.h"

#include <algorithm>
#include <limits>

#include <Eigen/LU>

namespace vpslam {

Eigen::Matrix3d AxisNaming::Matrix() const {
  Eigen::Matrix3d q = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) q(from[k], k) = sign[k];
  return q;
}

int AxisNaming::NameOf(int k) const {
  return static_cast<int>(std::find(from.begin(), from.end(), k) - from.begin());
}

AxisNaming NearestNaming(const Eigen::Matrix3d& cam_from_manhattan,
                         const Eigen::Matrix3d& predicted) {
  // cosine(i, k) of measured axis i and predicted axis k; the trace of predicted^T R Q, which grows
  // as the angle shrinks, is the sum of three of its entries with their signs.
  const Eigen::Matrix3d cosine = cam_from_manhattan.transpose() * predicted;
  AxisNaming best;
  double best_trace = -std::numeric_limits<double>::infinity();
  std::array<int, 3> from{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      AxisNaming naming;
      naming.from = from;
      double trace = 0;
      for (int k = 0; k < 3; ++k) {
        naming.sign[k] = signs >> k & 1 ? -1 : 1;
        trace += naming.sign[k] * cosine(from[k], k);
      }
      if (trace <= best_trace || naming.Matrix().determinant() < 0) continue;
      best = naming;
      best_trace = trace;
    }
  } while (std::next_permutation(from.begin(), from.end()));
  return best;
}

Eigen::Quaterniond NamedNearest(const Eigen::Quaterniond& cam_from_manhattan,
                                const Eigen::Quaterniond& predicted) {
  const Eigen::Matrix3d measured = cam_from_manhattan.toRotationMatrix();
  const AxisNaming naming = NearestNaming(measured, predicted.toRotationMatrix());
  return Eigen::Quaterniond(Eigen::Matrix3d(measured * naming.Matrix()));
}

}  // namespace vpslam
