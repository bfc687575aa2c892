// SPDX-License-Identifier: Apache-2.0
#include "tests/plugins/flight_logs/reader_fixture.h"

namespace lapwing {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST(GpxLog, ReadsTimesAndPlaces) {
  const auto states = short_flight();
  const auto reader = reader_named("gpx");
  const std::string bytes = gpx_of(states);
  ASSERT_TRUE(reader->recognizes(bytes));
  const FlightLog log = reader->read(bytes);
  EXPECT_THAT(faults_of(log), IsEmpty());
  ASSERT_EQ(log.find("place")->size(), states.size());
  for (std::size_t i = 0; i < states.size(); i += 5) {
    EXPECT_NEAR(log.find("place")->times[i], states[i].time - states[0].time, 1e-5);
    EXPECT_NEAR(row_of(log, "place", i)[2], place_of(states[i].position).altitude, 1e-4);
  }
  EXPECT_NEAR(*log.utc, 1715504400 + states[0].time, 1e-3);  // 2024-05-12T09:00 and 99.5 s
}

TEST(GpxLog, TimesMayHaveZonesAndNamesPrefixes) {
  const FlightLog log = reader_named("gpx")->read(
      "<?xml version='1.0'?><g:gpx xmlns:g='http://www.topografix.com/GPX/1/1'><g:trk><g:trkseg>"
      "<g:trkpt lat='1' "
      "lon='2'><g:ele>3</g:ele><g:time>2024-05-12T11:30:00+02:00</g:time></g:trkpt>"
      "<g:trkpt lat='1' lon='2'><g:ele>3</g:ele><g:time>2024-05-12T09:30:01.5Z</g:time></g:trkpt>"
      "</g:trkseg></g:trk></g:gpx>");
  EXPECT_THAT(log.find("place")->times, testing::ElementsAre(0, 1.5));
}

TEST(GpxLog, ATrackWithoutTimesNeedsARate) {
  std::string bytes = "<gpx><trk><trkseg>";
  for (int k = 0; k < 3; ++k) bytes += "<trkpt lat=\"1\" lon=\"2\"><ele>3</ele></trkpt>";
  bytes += "</trkseg></trk></gpx>";
  EXPECT_THAT(refusal_of(*reader_named("gpx"), bytes), HasSubstr("--format gpx:rate=10"));
  Value rate = Value::map();
  rate.set("rate", 10.0);
  EXPECT_THAT(reader_named("gpx", rate)->read(bytes).find("place")->times,
              testing::ElementsAre(0, 0.1, 0.2));
}

TEST(GpxLog, ACutFileIsReadToItsLastPoint) {
  const std::string bytes = gpx_of(short_flight());
  const FlightLog log = reader_named("gpx")->read(bytes.substr(0, bytes.size() / 2));
  EXPECT_THAT(log.damage, HasSubstr("line "));
  EXPECT_GT(log.find("place")->size(), 5u);
  EXPECT_GT(read_cut(*reader_named("gpx"), bytes.substr(0, 1500)), 100u);
}

TEST(GpxLog, RefusesEntitiesDepthAndOtherElements) {
  const auto reader = reader_named("gpx");
  EXPECT_THAT(refusal_of(*reader, "<!DOCTYPE gpx [<!ENTITY a \"b\">]><gpx>&a;</gpx>"),
              HasSubstr("a document type is declared"));
  std::string deep;
  for (int k = 0; k < 100; ++k) deep += "<gpx>";
  EXPECT_THAT(refusal_of(*reader, deep), HasSubstr("deeper than 64"));
  EXPECT_THAT(refusal_of(*reader, "<kml></kml>"), HasSubstr("expected an XML file with <gpx>"));
  EXPECT_THAT(refusal_of(*reader, "<gpx></gpx>"), HasSubstr("0 track points"));
}

}  // namespace
}  // namespace lapwing
