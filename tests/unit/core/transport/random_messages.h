// Messages with every member set at random, but sound: drawn from their descriptions.
#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/geometry/camera.h"
#include "core/messages/frame_features.h"
#include "core/messages/frame_pose.h"
#include "core/messages/keyframe_proposal.h"
#include "core/messages/map_delta.h"
#include "core/messages/preview.h"
#include "core/messages/visitor.h"
#include "core/transport/ack.h"
#include "core/transport/codec.h"
#include "core/transport/image_message.h"

namespace vpslam::test {

class RandomNumbers {
 public:
  explicit RandomNumbers(uint64_t seed) : random_(seed) {}

  template <class T = int>
  T Int(T low, T high) {
    return std::uniform_int_distribution<T>(low, high)(random_);
  }
  double Real(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  bool Bool() { return Int(0, 1) == 1; }

 private:
  std::mt19937_64 random_;
};

/// Visits a message and draws each member by its rule.
class Drawer : public Visitor<Drawer> {
 public:
  /// Arrays of a length that is not among `lengths` get up to 20 elements.
  Drawer(RandomNumbers& random, std::map<std::string, int, std::less<>> lengths)
      : random_(random), lengths_(std::move(lengths)) {}

  template <class T, class R>
  void Leaf(const char*, T& value, R rule) {
    Draw(value, rule);
  }
  template <class T, class R = AnyValue>
  void Array(const char* length, const char* name, T& vector, R rule = {}) {
    vector.resize(lengths_.try_emplace(length, random_.Int(0, 20)).first->second);
    Visitor::Array(length, name, vector, rule);
  }
  template <class T>
  void SizeOf(const char*, T& vector) {
    vector.resize(random_.Int(0, 20));
  }
  template <class T, class Member>
  void Pool(const char* length, const char* name, T& owners, Member member) {
    for (auto& owner : owners) Visitor::Array(length, name, owner.*member);
  }
  template <class P, class T, class F>
  void Optional(const char*, P& pointer, T value, F&& describe) {
    if (random_.Bool()) return;
    describe(*this, value);
    SetOptional(&pointer, std::move(value));
  }

 private:
  template <class T>
  T RandomId() {
    const auto session = static_cast<int32_t>(random_.Int(0, T::kMaxSession - 1));
    return T(session, random_.Int<int64_t>(0, T::kMaxIndex - 1));
  }
  template <class T>
  void Draw(T& value, AnyValue) {
    if constexpr (requires { value.IsValid(); }) {
      value = random_.Bool() ? RandomId<T>() : T();
    } else {
      ForEachScalar(value, [this](auto& scalar) {
        using Scalar = std::decay_t<decltype(scalar)>;
        if constexpr (std::is_same_v<Scalar, bool>) {
          scalar = random_.Bool();
        } else if constexpr (std::is_floating_point_v<Scalar>) {
          scalar = static_cast<Scalar>(random_.Real(-1e3, 1e3));
        } else {
          scalar = static_cast<Scalar>(random_.Int(std::numeric_limits<int64_t>::min(),
                                                   std::numeric_limits<int64_t>::max()));
        }
      });
    }
    if constexpr (IsRotation<T>) value.normalize();
  }
  template <class T>
  void Draw(T& id, Required) {
    id = RandomId<T>();
  }
  template <class T>
  void Draw(T& value, Between range) {
    const auto high = std::min<int64_t>(range.high, std::numeric_limits<T>::max());
    value = static_cast<T>(random_.Int(range.low, high));
  }
  template <class T>
  void Draw(T& value, Within range) {
    ForEachScalar(value, [&](auto& scalar) {
      scalar = static_cast<std::decay_t<decltype(scalar)>>(
          random_.Real(std::max(range.low, -1e3), std::min(range.high, 1e3)));
    });
  }
  void Draw(double& ms, Duration) {
    ms = random_.Bool() ? std::numeric_limits<double>::quiet_NaN() : random_.Real(0, 100);
  }
  template <class T>
  void Draw(T& vector, UnitLength) {
    Draw(vector, Within{-1, 1});
    vector.normalize();
  }
  template <class T, auto... values>
  void Draw(T& value, OneOf<values...>) {
    const T all[] = {values...};
    value = all[random_.Int<int>(0, sizeof...(values) - 1)];
  }
  void Draw(std::string& name, ProcessName) { Draw(name, Text{20}); }
  void Draw(std::string& text, Text) {
    text.resize(random_.Int(1, 20));
    for (char& c : text) c = static_cast<char>(random_.Int<int>('a', 'z'));
  }

  RandomNumbers& random_;
  std::map<std::string, int, std::less<>> lengths_;
};

/// Makes the members of a message fit each other, where their own rules do not see to that.
class Repairer : public RandomNumbers {
 public:
  using RandomNumbers::RandomNumbers;

  template <class T>
  void Repair(T*) {}
  void Repair(Header* h) {
    h->last = false;
    h->oldest_seq %= h->seq + 1;
  }
  void Repair(Camera* c) {
    c->width = Int(16, 2000);
    c->height = Int(16, 2000);
    c->fps = Real(1, 100);
    c->fx = Real(100, 1000);
    c->fy = Real(100, 1000);
    c->cx = Real(1, 15);
    c->cy = Real(1, 15);
    for (double* k : {&c->k1, &c->k2, &c->k3, &c->p1, &c->p2}) *k = Real(-0.01, 0.01);
    c->mask_runs.clear();
    int32_t left = c->width * c->height;
    for (int i = Bool() ? Int(2, 9) : 0; i > 0; --i) {
      c->mask_runs.push_back(i == 1 ? left : Int(1, left / 2));
      left -= c->mask_runs.back();
    }
  }
  void Repair(ImageMessage* m) {
    m->width = Int(1, 40);
    m->height = Int(1, 40);
    m->bytes.clear();
    if (Bool()) {
      m->segment.clear();
      for (int i = 0; i < m->width * m->height; ++i) m->bytes.push_back(Int(0, 255));
    } else {
      m->segment = "/vpslam-test_1";
      m->slot = Int(0, 9);
      m->generation = 2 * Int(1, 1000);
    }
  }
  void Repair(LineSet* s) {
    const int num_vps = static_cast<int>(s->vanishing_points.size());
    if (num_vps < 3) s->manhattan = ManhattanState::kNone;
    for (LineSegment& line : s->lines) line.label = Int(-1, num_vps - 1);
  }
  void Repair(FrameFeatures* f) {
    if (!f->lines) return;
    LineSet lines = *f->lines;
    Repair(&lines);
    f->lines = std::make_shared<const LineSet>(std::move(lines));
  }
  void Repair(FramePose* p) {
    if (p->state != TrackingState::kTracking) return;
    p->map.value = std::max<int64_t>(p->map.value, 0);
    p->reference.value = std::max<int64_t>(p->reference.value, 0);
  }
  void Repair(KeyframeProposal* k) {
    Repair(&k->lines);
    const int n = k->features.size();
    if (n == 0) k->initial_points.clear();
    if (n == 0) k->seam.points.clear();
    if (!k->initial_points.empty()) k->role = KeyframeRole::kMapSecond;
    for (InitialPoint& p : k->initial_points) p.feature_in_second %= n;
    for (auto& p : k->seam.points) p.feature %= n;
  }
  void Repair(MapDelta* d) {
    for (LineState& line : d->lines) {
      if (line.axis < 0) line.manhattan = ManhattanId();
      if (!line.manhattan.IsValid()) line.axis = -1;
    }
    if (d->version < d->base_version) std::swap(d->version, d->base_version);
  }
  void Repair(Preview* p) { p->jpeg.push_back(1); }
  void Repair(Ack* a) { a->done = std::min(a->done, a->received); }
};

class RandomMessages : public Repairer {
 public:
  using Repairer::Repairer;

  template <class T>
  T Make(std::map<std::string, int, std::less<>> lengths = {}) {
    T message;
    Drawer drawer(*this, std::move(lengths));
    Description<T>::Visit(drawer, message);
    Repair(&message);
    return message;
  }
};

}  // namespace vpslam::test
