#include "player/render_to_folder.h"

#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ostream.h>
#include <opencv2/imgcodecs.hpp>

namespace vpslam {
namespace {

namespace fs = std::filesystem;

class TextFile {
 public:
  explicit TextFile(const fs::path& path) : path_(path), stream_(path, std::ios::binary) {}

  template <class... Args>
  void Print(fmt::format_string<Args...> format, Args&&... args) {
    fmt::print(stream_, format, std::forward<Args>(args)...);
  }
  void Close() {
    stream_.close();
    if (!stream_) {
      throw std::runtime_error(
          path_.string() + ": cannot be written; name a folder with space and write permission");
    }
  }

 private:
  fs::path path_;
  std::ofstream stream_;
};

void PrepareFolder(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_empty(folder, error)) {
    throw std::runtime_error(folder.string() + ": exists and is not empty; name a new folder");
  }
  fs::create_directories(folder / "rgb", error);
  if (error) {
    throw std::runtime_error(folder.string() + ": cannot be created (" + error.message() +
                             "); name a folder with write permission");
  }
}

void WriteCamera(const Camera& c, const fs::path& path) {
  TextFile file(path);
  file.Print("# pinhole + radial-tangential, px, pixel centres at integer coordinates\n");
  file.Print("width: {}\nheight: {}\nfps: {}\n", c.width, c.height, c.fps);
  file.Print("fx: {}\nfy: {}\ncx: {}\ncy: {}\n", c.fx, c.fy, c.cx, c.cy);
  file.Print("k1: {}\nk2: {}\np1: {}\np2: {}\nk3: {}\n", c.k1, c.k2, c.p1, c.p2, c.k3);
  file.Close();
}

/// Index of the Manhattan direction of a segment, or -1.
int AxisOf(const Eigen::Vector3d& direction, const Eigen::Matrix3d& manhattan) {
  constexpr double kParallel = 1e-9;  // 1 - cos; edges are exact
  int axis = 0;
  const double cosine = (manhattan.transpose() * direction.normalized()).cwiseAbs().maxCoeff(&axis);
  return 1 - cosine < kParallel ? axis : -1;
}

void WriteTruth(const simulator::Simulator& simulator, const fs::path& folder) {
  TextFile lines(folder / "lines3d.txt");
  lines.Print("# ax ay az bx by bz kind axis : segments, m, world; axis of manhattan.txt or -1\n");
  for (const simulator::Line3d& line : simulator.lines3d()) {
    lines.Print("{:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {} {}\n", line.a.x(), line.a.y(),
                line.a.z(), line.b.x(), line.b.y(), line.b.z(),
                line.kind == simulator::LineKind::kEdge ? "edge" : "mark",
                AxisOf(line.b - line.a, simulator.manhattan()));
  }
  lines.Close();

  TextFile manhattan(folder / "manhattan.txt");
  manhattan.Print("# frame and the three orthogonal directions x y z each, unit norm, sign free\n");
  manhattan.Print("world");
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d d = simulator.manhattan().col(axis);
    manhattan.Print(" {:.9f} {:.9f} {:.9f}", d.x(), d.y(), d.z());
  }
  manhattan.Print("\n");
  manhattan.Close();
}

}  // namespace

void RenderToFolder(simulator::Simulator& simulator, const fs::path& folder,
                    const std::function<void(int)>& progress) {
  PrepareFolder(folder);
  WriteCamera(simulator.camera(), folder / "camera.yaml");
  WriteTruth(simulator, folder);
  TextFile list(folder / "rgb.txt"), truth(folder / "groundtruth.txt");
  list.Print("# timestamp filename\n");
  truth.Print("# timestamp tx ty tz qx qy qz qw : camera to world, m\n");
  for (int i = 0; i < simulator.frames(); ++i) {
    const std::string stamp = fmt::format("{}.{:06}", simulator.stamp_us(i) / 1'000'000,
                                          simulator.stamp_us(i) % 1'000'000);
    const std::string name = "rgb/" + stamp + ".png";
    // Noise hardly compresses, and what is not compressed is read in a fraction of the time.
    if (!cv::imwrite((folder / name).string(), simulator.Render(i),
                     {cv::IMWRITE_PNG_COMPRESSION, 0})) {
      throw std::runtime_error(
          (folder / name).string() +
          ": cannot be written; name a folder with space and write permission");
    }
    list.Print("{} {}\n", stamp, name);
    const SE3 pose = simulator.world_from_cam(i);
    const Eigen::Vector3d& t = pose.translation;
    const Eigen::Quaterniond& q = pose.rotation;
    truth.Print("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", stamp, t.x(), t.y(), t.z(),
                q.x(), q.y(), q.z(), q.w());
    progress(i + 1);
  }
  list.Close();
  truth.Close();
}

}  // namespace vpslam
