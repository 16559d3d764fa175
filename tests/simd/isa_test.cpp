// Selection of the instruction set: by default, by the environment, by call.

#include <gtest/gtest.h>
#include <winnow/simd/isa.h>

#include <array>
#include <cstdio>
#include <string>

namespace winnow::test {
namespace {

#ifdef WINNOW_PRINT_ISA
// Returns isa_name() of a separate process with this WINNOW_ISA.
std::string isa_of_a_process(const std::string& value) {
  const std::string command = "WINNOW_ISA='" + value + "' " WINNOW_PRINT_ISA;
  std::string output;
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return "popen failed";
  std::array<char, 64> line;
  while (std::fgets(line.data(), line.size(), pipe) != nullptr) output += line.data();
  EXPECT_EQ(::pclose(pipe), 0);
  return output;
}

TEST(Isa, environment_selects_the_active_isa) {
  for (const Isa isa : available_isas())
    EXPECT_EQ(isa_of_a_process(to_string(isa)), to_string(isa));
}

TEST(Isa, unknown_isa_falls_back_to_the_widest) {
  const std::string widest = to_string(available_isas().back());
  for (const char* name : {"", "sse9", "AVX2", "avx2 ", "none"}) {
    EXPECT_EQ(isa_of_a_process(name), widest) << name;
  }
#if WINNOW_HAVE_SSE42
  EXPECT_EQ(isa_of_a_process("neon64"), widest);
#else
  EXPECT_EQ(isa_of_a_process("avx2"), widest);
#endif
}
#endif

TEST(Isa, list_begins_with_the_baseline) {
  ASSERT_FALSE(available_isas().empty());
#if WINNOW_HAVE_SSE42
  EXPECT_EQ(available_isas().front(), Isa::sse42);
#else
  EXPECT_EQ(available_isas().front(), Isa::neon64);
#endif
}

TEST(Isa, set_isa_changes_the_active_isa) {
  const Isa before = active_isa();
  for (const Isa isa : available_isas()) {
    EXPECT_EQ(set_isa(isa), Status::ok);
    EXPECT_EQ(active_isa(), isa);
    EXPECT_STREQ(isa_name(), to_string(isa));
    EXPECT_EQ(set_isa(before), Status::ok);
    EXPECT_EQ(set_isa(std::string_view(to_string(isa))), Status::ok);
    EXPECT_EQ(active_isa(), isa);
  }
  EXPECT_EQ(set_isa(before), Status::ok);
}

TEST(Isa, unavailable_isa_changes_nothing) {
  const Isa before = active_isa();
#if WINNOW_HAVE_SSE42
  EXPECT_EQ(set_isa(Isa::neon64), Status::invalid_argument);
#else
  EXPECT_EQ(set_isa(Isa::avx2), Status::invalid_argument);
#endif
  EXPECT_EQ(set_isa(static_cast<Isa>(250)), Status::invalid_argument);
  EXPECT_EQ(set_isa("sse"), Status::invalid_argument);
  EXPECT_EQ(set_isa(""), Status::invalid_argument);
  EXPECT_EQ(active_isa(), before);
}

}  // namespace
}  // namespace winnow::test
