// What squared errors over their variance are compared with.
#pragma once

namespace vpslam {

/// 95 % quantiles of chi-square with one, two and three degrees of freedom: a gate on squared,
/// whitened residuals which one good measurement in twenty fails.
inline constexpr double kChi2Dof1 = 3.841;
inline constexpr double kChi2Dof2 = 5.991;
inline constexpr double kChi2Dof3 = 7.815;

}  // namespace vpslam
