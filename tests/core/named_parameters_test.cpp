// SPDX-License-Identifier: Apache-2.0
#include "framework/core/named_parameters.h"

#include <gtest/gtest.h>

namespace lapwing {
namespace {

TEST(NamedParameters, AreNumbersBooleansAndTexts) {
  const auto given =
      named_parameters_from("mpc:delay=-1.5e-2,fast=true,slow=false,mode=1m,word=a=b");
  ASSERT_TRUE(given);
  EXPECT_EQ(given->name, "mpc");
  EXPECT_EQ(given->parameters.at("delay").as_number(), -1.5e-2);
  EXPECT_TRUE(given->parameters.at("fast").as_boolean());
  EXPECT_FALSE(given->parameters.at("slow").as_boolean());
  EXPECT_EQ(given->parameters.at("mode").as_text(), "1m");
  EXPECT_EQ(given->parameters.at("word").as_text(), "a=b");
  EXPECT_EQ(given->parameters.as_map().size(), 5u);
}

TEST(NamedParameters, ANameAloneHasNone) {
  const auto given = named_parameters_from("csv");
  ASSERT_TRUE(given);
  EXPECT_EQ(given->name, "csv");
  EXPECT_TRUE(given->parameters.is_null());
}

TEST(NamedParameters, WhatIsNoListIsNone) {
  for (const char* text :
       {"a:", "a:b", "a:b=", "a:=1", "a:b=1,", "a:,b=1", "a:b=1,,c=2", "a:b=1,b=2", "a:b=1,c"})
    EXPECT_FALSE(named_parameters_from(text)) << text;
}

}  // namespace
}  // namespace lapwing
