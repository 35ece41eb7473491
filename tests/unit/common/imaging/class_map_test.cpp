#include "common/imaging/class_map.h"

#include <gmock/gmock.h>

#include <random>

namespace coach {
namespace {

using testing::ElementsAre;

TEST(ClassMap, CodesRunsAsDocumented) {
  std::vector<uint8_t> map(3, 5);
  map.insert(map.end(), 300, 0);
  map.push_back(2);
  EXPECT_THAT(EncodeClassMap(map), ElementsAre(5, 2, 0, 299 % 128 + 128, 299 / 128, 2, 0));
}

TEST(ClassMap, RandomMapsComeBackExactly) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<uint8_t> map;
    while (map.size() < 5000)
      map.insert(map.end(), 1 + random() % (trial % 2 ? 3 : 900), static_cast<uint8_t>(random() % 256));
    EXPECT_EQ(DecodeClassMap(EncodeClassMap(map), map.size()), map);
  }
}

TEST(ClassMap, EmptyStaysEmpty) {
  EXPECT_TRUE(EncodeClassMap({}).empty());
  EXPECT_TRUE(DecodeClassMap({}, 640 * 480).empty());
}

TEST(ClassMap, SpeckleIsSimplifiedUntilItFitsAndLargeRunsStay) {
  std::mt19937 random(2);
  std::vector<uint8_t> map(640 * 480);
  for (uint8_t& value : map) value = static_cast<uint8_t>(random() % 2);
  std::fill(map.begin() + 100'000, map.begin() + 150'000, uint8_t{4});
  const std::vector<uint8_t> bytes = EncodeClassMap(map);
  EXPECT_LE(bytes.size(), kMaxClassMapBytes);
  const std::vector<uint8_t> back = DecodeClassMap(bytes, map.size());
  EXPECT_TRUE(std::all_of(back.begin() + 100'000, back.begin() + 150'000, [](uint8_t v) { return v == 4; }));
}

TEST(ClassMap, AnyLimitIsKept) {
  const std::vector<uint8_t> map{1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(EncodeClassMap(map, 2).size(), 2U);
}

TEST(ClassMap, RefusesWhatDoesNotFillTheImageExactly) {
  const std::vector<uint8_t> map(100, 7);
  const std::vector<uint8_t> bytes = EncodeClassMap(map);
  EXPECT_THROW(DecodeClassMap(bytes, 99), std::invalid_argument);
  EXPECT_THROW(DecodeClassMap(bytes, 101), std::invalid_argument);
  EXPECT_THROW(DecodeClassMap(std::vector<uint8_t>{7}, 100), std::invalid_argument);
  EXPECT_THROW(DecodeClassMap(std::vector<uint8_t>{7, 255, 255, 255, 255, 255, 1}, 100), std::invalid_argument);
  EXPECT_THROW(DecodeClassMap(std::vector<uint8_t>{7, 255, 255, 255, 255, 127}, 100), std::invalid_argument);
  EXPECT_THROW(DecodeClassMap(std::vector<uint8_t>(kMaxClassMapBytes + 2, 0), 640 * 480), std::invalid_argument);
}

TEST(ClassMap, RandomBytesNeverCrash) {
  std::mt19937 random(3);
  int refused = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<uint8_t> bytes(1 + random() % 40);
    for (uint8_t& b : bytes) b = static_cast<uint8_t>(random());
    try {
      EXPECT_EQ(DecodeClassMap(bytes, 1000).size(), 1000U);
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1900);
}

}  // namespace
}  // namespace coach
