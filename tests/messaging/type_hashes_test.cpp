// SPDX-License-Identifier: BSD-3-Clause
// A hash changes with any member name, type or order: a type on the wire is never changed in place,
// it gets a new name. The values for bot_core are those of the robots in the field.
#include <bot_core/force_torque_t.hpp>
#include <bot_core/image_metadata_t.hpp>
#include <bot_core/image_t.hpp>
#include <bot_core/images_t.hpp>
#include <bot_core/joint_state_t.hpp>
#include <bot_core/pose_t.hpp>
#include <bot_core/position_3d_t.hpp>
#include <bot_core/quaternion_t.hpp>
#include <bot_core/rigid_transform_t.hpp>
#include <bot_core/robot_state_t.hpp>
#include <bot_core/system_status_t.hpp>
#include <bot_core/twist_t.hpp>
#include <bot_core/vector_3d_t.hpp>
#include <pronto/update_t.hpp>
#include <rigidfusion/body_motion_t.hpp>
#include <rigidfusion/body_pose_t.hpp>
#include <rigidfusion/camera_t.hpp>
#include <rigidfusion/command_t.hpp>
#include <rigidfusion/frame_tick_t.hpp>
#include <rigidfusion/grasp_t.hpp>
#include <rigidfusion/model_chunk_t.hpp>
#include <rigidfusion/model_state_t.hpp>
#include <rigidfusion/motion_prior_t.hpp>
#include <rigidfusion/planar_twist_t.hpp>
#include <rigidfusion/robot_shape_t.hpp>
#include <rigidfusion/segmentation_t.hpp>
#include <rigidfusion/service_status_t.hpp>
#include <rigidfusion/transform_t.hpp>

#include <gtest/gtest.h>

#include <cstdint>

namespace {

template <class T>
std::uint64_t hashOf() {
  return static_cast<std::uint64_t>(T::getHash());
}

TEST(TypeHashes, BotCoreIsWireCompatible) {
  EXPECT_EQ(hashOf<bot_core::pose_t>(), 0x2e16efb052b0105eULL);
  EXPECT_EQ(hashOf<bot_core::images_t>(), 0x20ba4f05e8f5e33aULL);
  EXPECT_EQ(hashOf<bot_core::image_metadata_t>(), 0x9a4b634d0577fb8eULL);
  EXPECT_EQ(hashOf<bot_core::image_t>(), 0x14739ffe13d5f5f0ULL);
  EXPECT_EQ(hashOf<bot_core::rigid_transform_t>(), 0xea9ffbf2acc5c5aeULL);
  EXPECT_EQ(hashOf<bot_core::system_status_t>(), 0x22c7cc36e9099eb6ULL);
  EXPECT_EQ(hashOf<bot_core::vector_3d_t>(), 0xae7e5fba5eeca11eULL);
  EXPECT_EQ(hashOf<bot_core::quaternion_t>(), 0x365bdd4bf9100a1fULL);
  EXPECT_EQ(hashOf<bot_core::position_3d_t>(), 0xee9ff44647af3f79ULL);
  EXPECT_EQ(hashOf<bot_core::twist_t>(), 0x6505e8bef050b34bULL);
  EXPECT_EQ(hashOf<bot_core::force_torque_t>(), 0xba9c10f6d7672920ULL);
  EXPECT_EQ(hashOf<bot_core::joint_state_t>(), 0x3e377b4cebc593a4ULL);
  EXPECT_EQ(hashOf<bot_core::robot_state_t>(), 0x7eca9a4a9f3575c7ULL);
  EXPECT_EQ(hashOf<pronto::update_t>(), 0x192f35ef0625f2b7ULL);
}

TEST(TypeHashes, OwnTypesArePinned) {
  EXPECT_EQ(hashOf<rigidfusion::body_motion_t>(), 0x1990409878185439ULL);
  EXPECT_EQ(hashOf<rigidfusion::body_pose_t>(), 0x5f8723c0bbf50e11ULL);
  EXPECT_EQ(hashOf<rigidfusion::camera_t>(), 0xd53ec27acd749a4cULL);
  EXPECT_EQ(hashOf<rigidfusion::command_t>(), 0x5cf5628e31e03b80ULL);
  EXPECT_EQ(hashOf<rigidfusion::frame_tick_t>(), 0x7853ad0ee7ab8535ULL);
  EXPECT_EQ(hashOf<rigidfusion::grasp_t>(), 0xfd95db4015fa00c5ULL);
  EXPECT_EQ(hashOf<rigidfusion::model_chunk_t>(), 0x8e0d727b98e8030dULL);
  EXPECT_EQ(hashOf<rigidfusion::model_state_t>(), 0xb1d57f4ecaea87ceULL);
  EXPECT_EQ(hashOf<rigidfusion::motion_prior_t>(), 0xd5e1e8b6c8a13100ULL);
  EXPECT_EQ(hashOf<rigidfusion::planar_twist_t>(), 0x7d97fddb5d34fe7eULL);
  EXPECT_EQ(hashOf<rigidfusion::robot_shape_t>(), 0xfee48fa9a7d78558ULL);
  EXPECT_EQ(hashOf<rigidfusion::segmentation_t>(), 0x78cf2c192c49f437ULL);
  EXPECT_EQ(hashOf<rigidfusion::service_status_t>(), 0x83b49aff55945822ULL);
  EXPECT_EQ(hashOf<rigidfusion::transform_t>(), 0x35e3f2dbeb74d3afULL);
}

}  // namespace
