// What squared errors over their variance are compared with.
#pragma once

namespace vpslam {

/// 95 % of chi-square with one and with two degrees of freedom.
constexpr double kChi2Dof1 = 3.841;
constexpr double kChi2Dof2 = 5.991;

}  // namespace vpslam
