// Reads the picture that says which part of a camera's images shows what moves with the camera.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace vpslam {

/// The runs (core/geometry/image_mask.h) of a picture of `width` x `height` px that is black, or
/// darker than middle grey, where nothing is to be seen. Throws std::runtime_error with one line
/// that names file, fault and remedy.
std::vector<int32_t> ReadMaskFile(const std::string& path, int width, int height);

}  // namespace vpslam
