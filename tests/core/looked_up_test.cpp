#include <gtest/gtest.h>
#include <winnow/core/indexed_view.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

namespace winnow::test {
namespace {

struct Square {
  int factor = 0;

  int operator()(std::size_t i) const { return factor * static_cast<int>(i * i); }
};

using Squares = IndexedView<Square>;

static_assert(std::random_access_iterator<Squares::iterator>);
static_assert(std::is_same_v<Squares::value_type, int>);

TEST(IndexedView, view_reads_like_a_span) {
  const Squares squares(Square{2}, 5);
  EXPECT_EQ(squares.size(), 5U);
  EXPECT_FALSE(squares.empty());
  EXPECT_EQ(squares[3], 18);
  EXPECT_EQ(squares.lookup().factor, 2);
  EXPECT_EQ(std::vector<int>(squares.begin(), squares.end()), (std::vector<int>{0, 2, 8, 18, 32}));
  EXPECT_TRUE(std::ranges::equal(squares, std::vector<int>{0, 2, 8, 18, 32}));
  EXPECT_EQ(std::ranges::lower_bound(squares, 10) - squares.begin(), 3);
  EXPECT_TRUE(Squares(Square{2}, 0).empty());
  EXPECT_EQ(Squares(Square{2}, 0).begin(), Squares(Square{2}, 0).end());
}

TEST(IndexedView, iterators_move_in_both_directions) {
  const Squares squares(Square{1}, 9);
  Squares::iterator at = squares.begin() + 4;
  EXPECT_EQ(*at, 16);
  EXPECT_EQ(*at++, 16);
  EXPECT_EQ(*at--, 25);
  EXPECT_EQ(*++at, 25);
  EXPECT_EQ(*--at, 16);
  EXPECT_EQ(at[-2], 4);
  at -= 3;
  EXPECT_EQ(*at, 1);
  EXPECT_EQ(*(2 + at), 9);
  EXPECT_EQ(*(at - 1), 0);
  EXPECT_EQ(squares.end() - at, 8);
  EXPECT_LT(at, squares.end());
  EXPECT_NE(at, squares.begin());
}

}  // namespace
}  // namespace winnow::test
