#include "mjdiag/render/scene/ghost.h"

#include <gtest/gtest.h>

#include "mjdiag/render/scene/scene_renderer.h"
#include "render/test_machine.h"

namespace mjdiag {
namespace {

class Ghosts : public ::testing::Test {
 protected:
  Ghosts() { ghost_data_->qpos[1] = 0.06; }  // the stage stands elsewhere

  Image Paint(const Ghost* ghost) {
    SceneRenderer renderer(*model_, {.width = 320, .height = 200, .camera = "front"});
    Image image;
    if (ghost == nullptr) {
      renderer.Render(*data_, image);
    } else {
      renderer.Render(*data_, *ghost_data_, *ghost, image);
    }
    return image;
  }

  const ModelPtr model_ = test::Machine();
  const DataPtr data_ = MakeData(*model_);
  const DataPtr ghost_data_ = MakeData(*model_);
};

TEST_F(Ghosts, AreNotDrawnOfBodiesThatStayTogether) {
  BodyDistances distances(*model_);
  distances.Compare(*data_, *ghost_data_);
  const std::vector<bool> bodies = distances.AtLeast(0.059);
  // World and base stay; stage, tilt and arm moved by 60 mm.
  EXPECT_EQ(bodies, (std::vector<bool>{false, false, true, true, true}));
  EXPECT_EQ(distances.AtLeast(0.061), std::vector<bool>(5, false));
}

TEST_F(Ghosts, CountATurnedBodyByWhatItsFarEndMoves) {
  ghost_data_->qpos[1] = 0.0;
  ghost_data_->qpos[2] = 0.01;  // the tilt turns the block below the arm
  BodyDistances distances(*model_);
  distances.Compare(*data_, *ghost_data_);
  EXPECT_TRUE(distances.AtLeast(0.0003)[3]);
  EXPECT_FALSE(distances.AtLeast(0.0003)[2]);
}

TEST_F(Ghosts, LeaveThePlainPictureIfNoBodyHasOne) {
  const Ghost none{std::vector<bool>(5, false)};
  EXPECT_EQ(Paint(&none), Paint(nullptr));
}

TEST_F(Ghosts, ShowMovedBodiesTheSameEveryTime) {
  const Ghost moved{{false, false, true, true, true}};
  const Image image = Paint(&moved);
  EXPECT_NE(image, Paint(nullptr));
  EXPECT_EQ(image, Paint(&moved));
}

TEST_F(Ghosts, LeaveFacesThatBothShareToTheMachine) {
  // Faces that both share are the machine's: no flicker between the two.
  ghost_data_->qpos[1] = 0.0;
  const Ghost all{std::vector<bool>(5, true)};
  const Image plain = Paint(nullptr);
  const Image image = Paint(&all);
  std::size_t different = 0;
  for (std::size_t i = 0; i < plain.rgb.size(); i += 3) {
    different += std::equal(&plain.rgb[i], &plain.rgb[i] + 3, &image.rgb[i]) ? 0U : 1U;
  }
  EXPECT_LT(different, plain.rgb.size() / 3 / 100);
}

TEST_F(Ghosts, AreGoneInTheNextPicture) {
  SceneRenderer renderer(*model_, {.width = 320, .height = 200, .camera = "front"});
  const Ghost all{std::vector<bool>(5, true)};
  Image image;
  renderer.Render(*data_, *ghost_data_, all, image);
  renderer.Render(*data_, image);
  EXPECT_EQ(image, Paint(nullptr));
}

}  // namespace
}  // namespace mjdiag
