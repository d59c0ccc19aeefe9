// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "simulation/builder.hpp"
#include "simulation/carry_scenes.hpp"
#include "simulation/manipulator.hpp"
#include "simulation/motion.hpp"
#include "simulation/world.hpp"

namespace rf::sim {
namespace {

using Place = Eigen::Vector2d;
constexpr double kPi = std::numbers::pi;

/// An Asus Xtion's colour camera: the size of one unit's calibration, fx and fy apart and the
/// principal point off the middle, so that no stage gets away with assuming otherwise.
Camera xtion() {
  Camera c;
  c.width = 640;
  c.height = 480;
  c.fx = 570.3;
  c.fy = 566.9;
  c.cx = 315.2;
  c.cy = 243.6;
  return c;
}

/// Rest, move, stop, move on: the choreography every carried object follows.
Profile restMoveStopMove(double rest, double stop, double go_on, double end) {
  return Profile({{rest, 0},
                  {rest + 1.0, 1},
                  {stop - 0.9, 1},
                  {stop, 0},
                  {go_on, 0},
                  {go_on + 1.0, 1},
                  {end - 0.9, 1},
                  {end, 0}});
}

Profile cruise(double begin, double end) {
  return Profile({{begin, 0}, {begin + 1.2, 1}, {end - 1.2, 1}, {end, 0}});
}

void setCamera(World& world, double height, double down, const std::function<Place(double)>& place,
               const std::function<double(double)>& yaw) {
  world.camera_at = [=](double t) { return cameraPose(place(t), height, yaw(t), down); };
}

void addMotion(World& world, const std::function<Place(double)>& place,
               const std::function<double(double)>& yaw) {
  world.body_at.emplace_back([=](double t) { return bodyPose(place(t), yaw(t)); });
}

std::function<double(double)> swing(double around, double amplitude, double period) {
  return [=](double t) { return around + amplitude * std::sin(2 * kPi * t / period); };
}

/// An object's yaw that swings with the way it has gone: it rests when the object rests.
std::function<double(double)> turning(const PlanarMotion& motion, double around, double amplitude) {
  return [=](double t) { return around + amplitude * std::sin(2.2 * motion.travelled(t)); };
}

std::function<Place(double)> along(const PlanarMotion& motion) {
  return [motion](double t) { return motion.position(t); };
}

std::function<double(double)> following(const Profile& profile) {
  return [profile](double t) { return profile.at(t); };
}

void straight(World& world, std::uint64_t seed) {
  const PlanarMotion camera(PlanarPath({{-1.25, 0.10}, {0.0, 0.02}, {1.1, -0.08}}),
                            cruise(0.2, 14.8));
  setCamera(world, 0.95, 0.06, along(camera), swing(0.0, 0.05, 9.0));
  const PlanarMotion object(PlanarPath({{2.14, 1.2}, {2.12, 0.0}, {2.12, -1.05}}),
                            Profile({{1.0, 0}, {2.2, 1}, {6.0, 1}, {7.0, 0}}));
  const PlanarMotion back(PlanarPath({{2.12, -1.05}, {2.12, 0.1}, {2.2, 1.25}}),
                          Profile({{8.6, 0}, {9.8, 1}, {13.2, 1}, {14.4, 0}}));
  const auto place = [=](double t) { return t < 8.6 ? object.position(t) : back.position(t); };
  addMotion(world, place, turning(object, 0.05, 0.03));
  buildStack(world, 1, {}, seed);
}

void orbit(World& world, std::uint64_t seed) {
  const Place centre(1.3, 0.0);
  const double radius = 1.9;
  const Profile angle_speed = cruise(0.2, 14.8);
  const double total = angle_speed.integral(14.8);
  const auto angle = [=](double t) { return -0.8 + 1.6 * angle_speed.integral(t) / total; };
  setCamera(
      world, 0.9, 0.05,
      [=](double t) {
        return Place(centre - radius * Place(std::cos(angle(t)), std::sin(angle(t))));
      },
      [=](double t) { return angle(t) + 0.05 * std::sin(0.9 * t); });
  // On a small circle, turning its front towards the camera.
  const Profile speed = restMoveStopMove(1.0, 6.5, 8.0, 14.5);
  const double round = speed.integral(14.5);
  const auto phase = [=](double t) { return 4.6 * speed.integral(t) / round; };
  addMotion(
      world,
      [=](double t) {
        return Place(centre + 0.38 * Place(std::cos(phase(t)), std::sin(phase(t))));
      },
      [=](double t) { return kPi + 0.4 + 0.55 * phase(t); });
  buildStack(world, 1, {}, seed);
}

void overtake(World& world, std::uint64_t seed) {
  const PlanarMotion camera(PlanarPath({{-1.3, -0.35}, {0.0, -0.35}, {1.05, -0.35}}),
                            cruise(0.2, 14.8));
  setCamera(world, 0.8, 0.07, along(camera), swing(0.08, 0.04, 11.0));
  const PlanarMotion object(
      PlanarPath({{0.15, 0.12}, {0.6, 0.0}, {1.3, -0.25}, {2.0, -0.3}, {2.45, -0.2}}),
      restMoveStopMove(1.0, 4.8, 8.2, 13.5));
  addMotion(world, along(object),
            following(Profile({{1.0, 0.15}, {4.8, 1.35}, {8.2, 1.35}, {13.5, 2.75}})));
  buildStack(world, 1, {}, seed);
}

void sideway(World& world, std::uint64_t seed) {
  const PlanarMotion camera(PlanarPath({{-0.15, -1.25}, {-0.1, 0.0}, {-0.15, 1.25}}),
                            cruise(0.2, 14.8));
  setCamera(world, 0.8, 0.07, along(camera), swing(0.0, 0.06, 10.0));
  const PlanarMotion object(PlanarPath({{1.6, -1.15},
                                        {1.06, -0.9},
                                        {1.55, -0.5},
                                        {1.03, -0.15},
                                        {1.55, 0.25},
                                        {1.03, 0.55},
                                        {1.55, 0.95},
                                        {1.05, 1.2}}),
                            restMoveStopMove(1.0, 6.6, 8.0, 14.3));
  addMotion(world, along(object), turning(object, 0.0, 0.1));
  buildStack(world, 1, {}, seed);
}

/// A broad stack passes close to the camera: `share` of the image's width at full height.
void sizeSweep(World& world, std::uint64_t seed, double share) {
  const double face = 0.95;  // distance of the near face
  // Of the columns 36 are borders without depth and about 31 lie in the stack's infrared shadow;
  // the line through the shares that were measured then corrects for the stack's visible sides.
  const double columns = (1.122 * share - 0.068) * (world.camera.width - 36 - 31);
  const double width = columns * face / world.camera.fx;
  const double depth = std::min(0.4, 2.0 * width);  // of a narrow stack the side would be most
  const double view = face * world.camera.width / world.camera.fx;
  const double travel = 0.9;  // of the camera, to the side
  const PlanarMotion camera(PlanarPath({{0.35, -travel / 2}, {0.35, travel / 2}}),
                            cruise(0.6, 5.9));
  setCamera(world, 0.8, 0.0, along(camera), swing(0.0, 0.02, 7.0));
  // From the view's right border to its left one, and with the camera.
  const double slack = 0.5 * (view - width);
  const PlanarMotion object(PlanarPath({{0.35 + face + depth / 2, -travel / 2 - 0.8 * slack},
                                        {0.35 + face + depth / 2, travel / 2 + 0.8 * slack}}),
                            Profile({{1.0, 0}, {1.9, 1}, {4.9, 1}, {5.8, 0}}));
  addMotion(world, along(object), turning(object, 0.0, 0.04));
  StackSize size;
  size.extent = {depth, width, 1.25};
  size.flush = true;
  buildStack(world, 1, size, seed);
}

void held(World& world, std::uint64_t seed) {
  setCamera(
      world, 1.0, 0.05, [](double) { return Place(0.2, 0.0); }, [](double) { return 0.0; });
  const Profile effort({{1.0, 0}, {2.0, 1}, {4.6, 1}, {5.2, 0}, {6.0, 0}, {6.8, 1}});
  world.body_at.emplace_back([effort](double t) {
    const double s = effort.integral(t);
    const Vec3 place(0.2 + 0.68 + 0.07 * std::sin(1.3 * s), 0.15 * std::sin(1.9 * s) - 0.02,
                     1.03 + 0.07 * std::sin(2.3 * s));
    const Eigen::Quaterniond q = Eigen::AngleAxisd(0.6 + 0.45 * std::sin(1.5 * s), Vec3::UnitZ()) *
                                 Eigen::AngleAxisd(0.3 * std::sin(1.1 * s), Vec3::UnitY()) *
                                 Eigen::AngleAxisd(0.25 * std::sin(1.7 * s), Vec3::UnitX());
    return SE3(q, place);
  });
  buildHeldCarton(world, 1, seed);
}

void loop(World& world, std::uint64_t) {
  const Profile speed = cruise(0.3, 14.7);
  const double total = speed.integral(14.7);
  const auto angle = [=](double t) { return 2 * kPi * speed.integral(t) / total; };
  setCamera(
      world, 0.95, 0.05,
      [=](double t) { return Place(-0.5 * Place(std::cos(angle(t)), std::sin(angle(t)))); }, angle);
  world.bodies = 1;
}

void twoObjects(World& world, std::uint64_t seed) {
  const PlanarMotion camera(PlanarPath({{-0.4, -1.1}, {-0.3, 0.0}, {-0.4, 1.1}}),
                            cruise(0.2, 14.8));
  setCamera(world, 0.95, 0.05, along(camera), swing(0.0, 0.05, 10.0));
  const PlanarMotion first(PlanarPath({{1.15, -0.9}, {1.5, -0.3}, {1.1, 0.3}, {1.4, 0.9}}),
                           restMoveStopMove(1.0, 6.6, 8.0, 14.3));
  addMotion(world, along(first), turning(first, 0.0, 0.1));
  const PlanarMotion second(PlanarPath({{2.3, 0.9}, {2.2, 0.0}, {2.3, -1.0}}),
                            restMoveStopMove(2.0, 7.5, 9.5, 14.0));
  addMotion(world, along(second), following(Profile({{2.0, 0.4}, {13.5, 1.6}})));
  world.bodies = 3;
  buildStack(world, 1, {}, seed);
  StackSize small;
  small.extent = {0.35, 0.45, 0.75};
  buildStack(world, 2, small, seed);
}

/// A slow drive to the side, so that the camera's path does not hide what the object does.
void ambleSideways(World& world) {
  const PlanarMotion camera(PlanarPath({{-0.45, -0.45}, {-0.4, 0.0}, {-0.45, 0.45}}),
                            cruise(0.2, 14.8));
  setCamera(world, 0.85, 0.05, along(camera), swing(0.0, 0.03, 10.0));
}

/// Out of the view to the left, on a curve where nobody sees it, and back in.
void leave(World& world, std::uint64_t seed) {
  ambleSideways(world);
  const PlanarMotion object(PlanarPath({{1.1, -0.35},
                                        {1.15, 0.4},
                                        {1.05, 1.15},
                                        {1.0, 1.7},
                                        {1.3, 1.75},
                                        {1.45, 1.2},
                                        {1.35, 0.5},
                                        {1.3, 0.0}}),
                            Profile({{1.0, 0}, {2.2, 1}, {12.0, 1}, {13.2, 0}}));
  addMotion(world, along(object), turning(object, 0.0, 0.12));
  buildStack(world, 1, {}, seed);
}

/// Behind a folding screen, hidden from top to wheels for about a second, and on.
void behind(World& world, std::uint64_t seed) {
  ambleSideways(world);
  const PlanarMotion object(PlanarPath({{1.75, -0.8}, {1.8, 0.0}, {1.85, 0.8}, {1.7, 1.15}}),
                            Profile({{1.0, 0}, {2.2, 1}, {9.8, 1}, {11.0, 0}}));
  addMotion(world, along(object), turning(object, 0.0, 0.05));
  buildStack(world, 1, {}, seed);
  buildScreen(world, {0.9, 0.2}, 0.44, 1.5, seed);
}

}  // namespace

const std::vector<SceneInfo>& scenes() {
  static const std::vector<SceneInfo> kScenes = [] {
    std::vector<SceneInfo> out = {
        {"straight", 450,
         "camera drives straight on, the object crosses in front of it and returns"},
        {"orbit", 450, "camera circles the object, which circles and turns towards it"},
        {"overtake", 450, "camera drives straight on, the object moves on beside it and turns"},
        {"sideway", 450, "camera moves sideways, the object zig-zags towards it and away"},
        {"held", 360, "camera rests, a hand waves a carton close to it"},
        {"loop", 450, "nothing moves but the camera: a circle with a full turn, closed"},
        {"two_objects", 450, "camera moves sideways, two stacks move independently"},
        {"leave", 450, "the object drives out of the view, turns round unseen and comes back"},
        {"behind", 450, "the object passes behind a folding screen, hidden for about a second"}};
    for (const int share : {14, 30, 40, 43, 50, 55, 60, 65, 70, 72, 75, 80, 85}) {
      out.push_back({"size0" + std::to_string(share), 180,
                     "a broad stack passes close by, about " + std::to_string(share) +
                         " % of the valid pixels"});
    }
    for (const auto& [name, summary] :
         {std::pair{"carry_omni", "a robot drives sideways and turns, its arm waves a carton"},
          {"carry_diff", "a robot on two wheels grasps a carton, lifts it and drives a curve"},
          {"carry_head", "a robot carries a carton and looks about with its pan-tilt head"}}) {
      out.push_back({name, 450, summary});
    }
    out.push_back({"calibrate_drive", 1800, "a robot drives circles, its arm out of the view"});
    out.push_back({"calibrate_grasp", 900, "a robot stands and turns a carton about all axes"});
    return out;
  }();
  return kScenes;
}

World buildWorld(const std::string& scene, std::uint64_t seed) {
  const SceneInfo* info = nullptr;
  std::string known;
  for (const SceneInfo& s : scenes()) {
    if (s.name == scene) info = &s;
    known += (known.empty() ? "" : ", ") + s.name;
  }
  if (info == nullptr) {
    throw std::invalid_argument("scene \"" + scene + "\" is unknown; there are " + known);
  }
  World world;
  world.camera = xtion();
  world.frames = info->frames;
  world.bodies = 2;
  Random layout(seed, 0x1A10);
  RoomSize room;
  room.half_x += layout.uniform(-0.1, 0.15);
  room.half_y += layout.uniform(-0.1, 0.15);
  room.height += layout.uniform(-0.1, 0.2);
  buildRoom(world, room, seed);
  if (scene == "straight") straight(world, seed);
  if (scene == "orbit") orbit(world, seed);
  if (scene == "overtake") overtake(world, seed);
  if (scene == "sideway") sideway(world, seed);
  if (scene == "held") held(world, seed);
  if (scene == "loop") loop(world, seed);
  if (scene == "two_objects") twoObjects(world, seed);
  if (scene == "leave") leave(world, seed);
  if (scene == "behind") behind(world, seed);
  buildCarryScene(world, scene, seed);
  if (scene.starts_with("size0")) sizeSweep(world, seed, std::stod(scene.substr(5)) / 100.0);
  return world;
}

int firstRobotBody(const World& world) {
  return world.robot ? world.robot->first_body : world.bodies;
}

std::vector<SE3> bodyPoses(const World& world, double seconds) {
  std::vector<SE3> poses = {SE3()};
  for (const auto& at : world.body_at) poses.push_back(at(seconds));
  return poses;
}

}  // namespace rf::sim
