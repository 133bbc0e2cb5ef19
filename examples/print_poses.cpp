// Prints the poses of a running VP-SLAM graph, with nothing but LCM and the message types:
//
//   print_poses 'udpm://239.255.76.67:PORT?ttl=0'
#include <cstdio>
#include <string>

#include <lcm/lcm-cpp.hpp>

#include "lcmtypes/vpslam/pose_t.hpp"

namespace {

void OnPose(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
            const vpslam::pose_t* pose, void* /*user*/) {
  if (pose->header.last) {
    std::printf("the sequence has ended\n");
  } else if (pose->state != vpslam::pose_t::TRACKING) {
    std::printf("frame %ld  %s\n", static_cast<long>(pose->frame_seq),
                pose->state == vpslam::pose_t::LOST ? "lost" : "initialising");
  } else {
    // x_cam = R x_world + t, R as a unit quaternion w, x, y, z.
    const double* q = pose->cam_from_world.rotation;
    const double* t = pose->cam_from_world.translation;
    std::printf("frame %ld  q %.4f %.4f %.4f %.4f  t %.3f %.3f %.3f  %d points%s\n",
                static_cast<long>(pose->frame_seq), q[0], q[1], q[2], q[3], t[0], t[1], t[2],
                pose->inliers, pose->live ? "" : "  (found later)");
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  // The default queue keeps 30 messages and drops further ones; nothing is to be lost here.
  lcm::LCM lcm(argc > 1 ? argv[1] : "udpm://239.255.76.67:7667?ttl=0");
  if (!lcm.good()) {
    std::fprintf(stderr, "print_poses: cannot join; is there a route for multicast?\n");
    return 1;
  }
  lcm.subscribeFunction("POSE", OnPose, static_cast<void*>(nullptr))->setQueueCapacity(0);
  while (lcm.handle() == 0) {
  }
}
