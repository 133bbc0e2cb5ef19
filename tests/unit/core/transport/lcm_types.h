// What lcm-gen makes of lcmtypes/.
#pragma once

#include "lcmtypes/vpslam/ack_t.hpp"
#include "lcmtypes/vpslam/camera_t.hpp"
#include "lcmtypes/vpslam/command_t.hpp"
#include "lcmtypes/vpslam/features_t.hpp"
#include "lcmtypes/vpslam/image_t.hpp"
#include "lcmtypes/vpslam/keyframe_t.hpp"
#include "lcmtypes/vpslam/lines_request_t.hpp"
#include "lcmtypes/vpslam/lines_t.hpp"
#include "lcmtypes/vpslam/map_delta_t.hpp"
#include "lcmtypes/vpslam/map_request_t.hpp"
#include "lcmtypes/vpslam/outcome_t.hpp"
#include "lcmtypes/vpslam/pose_t.hpp"
#include "lcmtypes/vpslam/preview_t.hpp"
#include "lcmtypes/vpslam/run_t.hpp"
#include "lcmtypes/vpslam/status_t.hpp"
#include "lcmtypes/vpslam/truth_t.hpp"
