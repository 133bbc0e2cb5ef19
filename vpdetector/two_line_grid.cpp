#include "vpdetector/two_line_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include <Eigen/Geometry>

#include "core/geometry/random_sample.h"

namespace vpslam {
namespace {

constexpr int kLatitudes = 90;    // degrees from the optical axis
constexpr int kLongitudes = 360;  // degrees from the x axis

/// atan(t) for t in [0, 1] to 1e-5 rad ([Abramowitz64] 4.4.49): a cell is 0.017 rad wide.
inline float AtanUnit(float t) {
  const float u = t * t;
  return t *
         (0.9998660f + u * (-0.3302995f + u * (0.1801410f + u * (-0.0851330f + u * 0.0208351f))));
}

/// atan2 in degrees, in [0, 360).
inline float Atan2_deg(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float angle = AtanUnit(std::min(ax, ay) / (std::max(ax, ay) + 1e-30f));
  float degrees = angle * static_cast<float>(180.0 / std::numbers::pi);
  degrees = ay > ax ? 90.0f - degrees : degrees;
  degrees = x < 0 ? 180.0f - degrees : degrees;
  return y < 0 ? 360.0f - degrees : degrees;
}

/// Cell of the direction (x, y, z) or of its opposite, whichever lies before the camera.
inline int Cell(float x, float y, float z) {
  const float flip = z < 0 ? -1.0f : 1.0f;
  const float latitude = Atan2_deg(std::sqrt(x * x + y * y), std::abs(z));
  const float longitude = Atan2_deg(flip * y, flip * x);
  const int row = std::min(static_cast<int>(latitude), kLatitudes - 1);
  int column = static_cast<int>(longitude);
  column = column >= kLongitudes ? 0 : column;
  return row * kLongitudes + column;
}

using Grid = std::vector<float>;  // kLatitudes x kLongitudes

/// Step 2. Works on a copy with a rim of one cell that holds what lies over each border.
Grid Smooth(const Grid& votes) {
  constexpr int kWidth = kLongitudes + 2;
  Grid rimmed(static_cast<size_t>((kLatitudes + 2) * kWidth));
  for (int row = -1; row <= kLatitudes; ++row) {
    // Over the pole or the equator: the same latitude on the opposite meridian.
    const bool over = row < 0 || row >= kLatitudes;
    const int from_row = std::clamp(row, 0, kLatitudes - 1);
    for (int column = -1; column <= kLongitudes; ++column) {
      const int from_column = (column + (over ? kLongitudes / 2 : 0) + kLongitudes) % kLongitudes;
      rimmed[static_cast<size_t>((row + 1) * kWidth + column + 1)] =
          votes[static_cast<size_t>(from_row * kLongitudes + from_column)];
    }
  }
  Grid smooth(votes.size());
  for (int row = 0; row < kLatitudes; ++row) {
    const float* above = rimmed.data() + row * kWidth;
    const float* here = above + kWidth;
    const float* below = here + kWidth;
    float* out = smooth.data() + row * kLongitudes;
    for (int c = 0; c < kLongitudes; ++c) {
      const float sum = above[c] + above[c + 1] + above[c + 2] + here[c] + here[c + 1] +
                        here[c + 2] + below[c] + below[c + 1] + below[c + 2];
      out[c] = here[c + 1] + sum / 9.0f;
    }
  }
  return smooth;
}

/// Step 1.
Grid Vote(const std::vector<VpLine>& lines, const std::vector<size_t>& order) {
  const size_t n = order.size();
  std::vector<float> x(n), y(n), z(n), u(n), v(n), root(n);
  for (size_t i = 0; i < n; ++i) {
    const VpLine& line = lines[order[i]];
    x[i] = static_cast<float>(line.normal.x());
    y[i] = static_cast<float>(line.normal.y());
    z[i] = static_cast<float>(line.normal.z());
    u[i] = static_cast<float>(line.direction.x());
    v[i] = static_cast<float>(line.direction.y());
    root[i] = static_cast<float>(std::sqrt(line.length_px));
  }
  Grid votes(static_cast<size_t>(kLatitudes * kLongitudes), 0.0f);
  std::vector<int> cell(n);
  std::vector<float> weight(n);
  for (size_t i = 0; i + 1 < n; ++i) {
    // Two loops: the first runs in SIMD, the second scatters.
    for (size_t j = i + 1; j < n; ++j) {
      const float cx = y[i] * z[j] - z[i] * y[j];
      const float cy = z[i] * x[j] - x[i] * z[j];
      const float cz = x[i] * y[j] - y[i] * x[j];
      const float cosine = std::abs(u[i] * u[j] + v[i] * v[j]);
      const float sine = std::abs(u[i] * v[j] - v[i] * u[j]);
      const float sin_2theta = sine < cosine ? 2 * sine * cosine : 1.0f;
      // Two fragments of one line meet nowhere in particular.
      const bool meet = cx * cx + cy * cy + cz * cz > 1e-10f;
      weight[j] = meet ? root[i] * root[j] * (sin_2theta + 0.2f) : 0.0f;
      cell[j] = Cell(cx, cy, cz);
    }
    for (size_t j = i + 1; j < n; ++j) votes[static_cast<size_t>(cell[j])] += weight[j];
  }
  return votes;
}

}  // namespace

std::optional<std::string> TwoLineGridOptions::Validate() const {
  if (num_first_directions < 1 || num_first_directions > 100000) {
    return "num_first_directions must lie in 1 to 100000";
  }
  if (!(label_deg > 0 && label_deg < 45)) return "label_deg must lie between 0 and 45";
  if (max_lines < 3) return "max_lines must be at least 3";
  return std::nullopt;
}

std::optional<TwoLineGridResult> SearchTwoLineGrid(const std::vector<VpLine>& lines,
                                                   const TwoLineGridOptions& options) {
  if (lines.size() < 3) return std::nullopt;
  std::vector<size_t> order(lines.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return lines[a].length_px > lines[b].length_px; });
  order.resize(std::min(order.size(), static_cast<size_t>(options.max_lines)));
  const Grid grid = Smooth(Vote(lines, order));

  std::mt19937_64 rng(options.seed);
  float best_score = 0;
  TwoLineGridResult best;
  bool found = false;
  for (int h = 0; h < options.num_first_directions; ++h) {
    const auto [i, j] = RandomSample<2>(static_cast<int>(order.size()), rng);
    const Eigen::Vector3d& s0 = lines[order[static_cast<size_t>(i)]].normal;
    const Eigen::Vector3d& s1 = lines[order[static_cast<size_t>(j)]].normal;
    Eigen::Vector3d first = s0.cross(s1);
    const double norm = first.norm();
    if (norm < 1e-3) continue;
    first /= norm;
    Eigen::Index smallest = 0;
    first.cwiseAbs().minCoeff(&smallest);
    const Eigen::Vector3d a = first.cross(Eigen::Vector3d::Unit(smallest)).normalized();
    const Eigen::Vector3d b = first.cross(a);
    const Eigen::Vector3f af = a.cast<float>(), bf = b.cast<float>(), ff = first.cast<float>();
    const float first_cell = grid[static_cast<size_t>(Cell(ff.x(), ff.y(), ff.z()))];
    static const std::vector<float> kCosSin = [] {
      std::vector<float> table;
      for (int degree = 0; degree < 90; ++degree) {
        table.push_back(static_cast<float>(std::cos(degree * std::numbers::pi / 180)));
        table.push_back(static_cast<float>(std::sin(degree * std::numbers::pi / 180)));
      }
      return table;
    }();
    int cell_of_second[90], cell_of_third[90];
    for (int degree = 0; degree < 90; ++degree) {
      const float c = kCosSin[static_cast<size_t>(2 * degree)];
      const float s = kCosSin[static_cast<size_t>(2 * degree + 1)];
      cell_of_second[degree] =
          Cell(c * af.x() + s * bf.x(), c * af.y() + s * bf.y(), c * af.z() + s * bf.z());
      cell_of_third[degree] =
          Cell(c * bf.x() - s * af.x(), c * bf.y() - s * af.y(), c * bf.z() - s * af.z());
    }
    for (int degree = 0; degree < 90; ++degree) {
      const float score = first_cell + grid[static_cast<size_t>(cell_of_second[degree])] +
                          grid[static_cast<size_t>(cell_of_third[degree])];
      if (found && score <= best_score) continue;
      found = true;
      best_score = score;
      const double angle = degree * std::numbers::pi / 180;
      best.cam_from_manhattan.col(0) = first;
      best.cam_from_manhattan.col(1) = std::cos(angle) * a + std::sin(angle) * b;
      best.cam_from_manhattan.col(2) = std::cos(angle) * b - std::sin(angle) * a;
    }
  }
  if (!found) return std::nullopt;
  best.score = best_score;

  // Step 4.
  const double label_sine = std::sin(options.label_deg * std::numbers::pi / 180);
  best.labels.assign(lines.size(), -1);
  for (size_t i = 0; i < lines.size(); ++i) {
    double nearest = label_sine;
    for (int k = 0; k < 3; ++k) {
      // The way from the middle of the line to the vanishing point, which may lie at infinity.
      const Eigen::Vector3d d = best.cam_from_manhattan.col(k);
      const Eigen::Vector2d way = d.head<2>() - d.z() * lines[i].middle;
      const double norm = way.norm();
      if (norm < 1e-12) continue;
      const double sine =
          std::abs(way.x() * lines[i].direction.y() - way.y() * lines[i].direction.x()) / norm;
      if (sine < nearest) {
        nearest = sine;
        best.labels[i] = k;
      }
    }
  }
  return best;
}

}  // namespace vpslam
