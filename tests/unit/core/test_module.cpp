#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/module.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Module, ASymbolIsFound) {
  const void* const cosine = load_module("libm.so.6", "cos", {"the mathematics of C", "computes"});
  ASSERT_NE(cosine, nullptr);
  EXPECT_EQ(reinterpret_cast<double (*)(double)>(const_cast<void*>(cosine))(0), 1);
}

TEST(Module, WhatIsMissingIsNamedWithTheRemedy) {
  EXPECT_THAT(
      [] {
        load_module("cloudbow_none.so", "it", {"nothing", "does nothing"});
      },
      ThrowsMessage<InputError>(
          AllOf(HasSubstr("cloudbow_none.so: the part of cloudbow that does nothing"), HasSubstr("LD_LIBRARY_PATH"))));
  EXPECT_THAT(
      [] {
        load_module("libm.so.6", "no_such_function", {"nothing", "does nothing"});
      },
      ThrowsMessage<InputError>(HasSubstr("no_such_function")));
}

}  // namespace
}  // namespace cloudbow
