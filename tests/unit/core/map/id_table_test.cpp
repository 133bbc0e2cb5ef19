#include "core/map/id_table.h"

#include <map>
#include <random>

#include <gtest/gtest.h>

#include "core/base/ids.h"
#include "core/map/votes.h"

namespace vpslam {
namespace {

struct Thing {
  PointId id;
  int value = 0;
};
using Table = IdTable<PointId, Thing>;

Thing& Insert(Table* table, PointId id, int value) {
  Thing& thing = table->Insert(id);
  thing = {id, value};
  return thing;
}

TEST(IdTable, HoldsWhatAMapHolds) {
  std::mt19937 rng(1);
  Table table;
  std::map<PointId, int> expected;
  std::map<PointId, const Thing*> address;
  for (int step = 0; step < 20'000; ++step) {
    const PointId id(static_cast<int32_t>(rng() % 3), static_cast<int64_t>(rng() % 5000));
    if (rng() % 2 == 0) {
      if (!expected.contains(id)) address[id] = &Insert(&table, id, step);
      expected.try_emplace(id, step);
    } else {
      table.Erase(id);
      expected.erase(id);
    }
  }
  ASSERT_EQ(table.size(), static_cast<int>(expected.size()));
  auto at = expected.begin();
  for (const Thing& thing : table) {
    ASSERT_EQ(thing.id, at->first);
    ASSERT_EQ(thing.value, at->second);
    ASSERT_EQ(&thing, address.at(thing.id)) << "things stay where they are";
    ++at;
  }
  EXPECT_EQ(at, expected.end());
}

TEST(IdTable, UnknownAndSenselessIdsAreNotThere) {
  Table table;
  Insert(&table, PointId(1, 700), 1);
  for (const PointId id : {PointId(), PointId(700), PointId(1, 699), PointId(1, 701),
                           PointId(2, 700), PointId(int64_t{-700}), PointId(9, 1 << 30)}) {
    EXPECT_EQ(table.Find(id), nullptr) << id.value;
    table.Erase(id);
  }
  EXPECT_EQ(table.size(), 1);
}

TEST(IdTable, WhatComesAndGoesTakesNoRoom) {
  Table table;
  for (int i = 0; i < 100'000; ++i) {
    Insert(&table, PointId(i), i);
    table.Erase(PointId(i - 10));
  }
  EXPECT_EQ(table.size(), 10);
  EXPECT_LE(table.num_slots(), 11);
}

TEST(IdTable, WhatIsVisitedMayBeErased) {
  Table table;
  for (int i = 0; i < 1000; ++i) Insert(&table, PointId(i), i);
  for (const Thing& thing : table) {
    if (thing.value % 3 != 0) table.Erase(thing.id);
  }
  EXPECT_EQ(table.size(), 334);
  EXPECT_EQ(table.begin()->id, PointId(0));
}

TEST(IdTable, CopiesAreTheirOwn) {
  Table table;
  Insert(&table, PointId(5), 5);
  Table copy = table;
  copy.Find(PointId(5))->value = 6;
  copy.Erase(PointId(5));
  EXPECT_EQ(table.Find(PointId(5))->value, 5);
}

TEST(Votes, AreRankedByNumberThenById) {
  Table table;
  for (const int i : {7, 3, 5, 9}) Insert(&table, PointId(i), i);
  Votes votes(table);
  for (const int i : {9, 9, 3, 7, 4, -1}) votes.Add(PointId(i));
  const std::vector<std::pair<PointId, int>> expected{
      {PointId(9), 2}, {PointId(3), 1}, {PointId(7), 1}};
  EXPECT_EQ(votes.Ranked(), expected);
  EXPECT_EQ(votes.Of(PointId(5)), 0);
}

TEST(Marks, AreSetOnce) {
  Table table;
  Insert(&table, PointId(3), 3);
  Marks marks(table);
  EXPECT_FALSE(marks.Contains(PointId(3)));
  EXPECT_TRUE(marks.Insert(PointId(3)));
  EXPECT_FALSE(marks.Insert(PointId(3)));
  EXPECT_TRUE(marks.Contains(PointId(3)));
  EXPECT_FALSE(marks.Insert(PointId(4))) << "it is not in the table";
}

}  // namespace
}  // namespace vpslam
