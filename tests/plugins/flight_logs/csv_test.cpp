// SPDX-License-Identifier: Apache-2.0
#include "tests/plugins/flight_logs/reader_fixture.h"

#include "framework/export/exporter.h"

namespace lapwing {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST(CsvLog, ReadsAirdataInFeetAndMiles) {
  const auto states = short_flight();
  const FlightLog log = reader_named("csv")->read(airdata_of(states));
  EXPECT_EQ(log.recorder, "Airdata");
  EXPECT_EQ(log.heights, HeightOf::sea);
  EXPECT_THAT(faults_of(log), IsEmpty());
  ASSERT_EQ(log.find("place")->size(), states.size());
  for (std::size_t i = 0; i < states.size(); i += 5) {
    const RecordedState& s = states[i];
    EXPECT_NEAR(log.find("place")->times[i], s.time, 1e-6);
    const Eigen::Vector3d row = row_of(log, "place", i);
    const GeodeticPoint p = place_of(s.position);
    EXPECT_NEAR(row.x(), p.latitude_deg, 1e-8);
    EXPECT_NEAR(row.y(), p.longitude_deg, 1e-8);
    EXPECT_NEAR(row.z(), p.altitude, 1e-4);
    EXPECT_LT((row_of(log, "velocity", i) - s.velocity).norm(), 1e-4);
    EXPECT_NEAR(row_of(log, "camera", i)[1], s.camera.y(), 1e-5);
    EXPECT_NEAR(std::remainder(row_of(log, "yaw", i)[0] - s.yaw, 2 * M_PI), 0, 1e-5);
  }
  EXPECT_NEAR(*log.utc + states[0].time, 1715506200, 1e-3);  // 2024-05-12 09:30:00
}

TEST(CsvLog, ReadsOtherApps) {
  const FlightLog litchi = reader_named("csv")->read(
      "latitude,longitude,altitude(m),time(millisecond),velocityX(mps),velocityY(mps),velocityZ("
      "mps)"
      ",pitch(deg),roll(deg),yaw(deg),istakingphoto,gimbalPitchRaw,gimbalRollRaw,gimbalYawRaw\n"
      "46.5,6.5,10,1000,1,2,3,0,0,90,0,-300,0,900\n46.5,6.5,11,1100,1,2,3,0,0,90,1,-300,0,900\n");
  EXPECT_EQ(litchi.recorder, "Litchi");
  EXPECT_EQ(litchi.heights, HeightOf::ground);
  EXPECT_EQ(row_of(litchi, "velocity", 0), Eigen::VectorXd(Eigen::Vector3d(2, 1, -3)));
  EXPECT_NEAR(row_of(litchi, "camera", 0)[1], -M_PI / 6, 1e-12);
  EXPECT_NEAR(row_of(litchi, "camera", 0)[0], 0, 1e-12);
  EXPECT_THAT(litchi.photographs, testing::ElementsAre(1.1));
  const FlightLog dji = reader_named("csv")->read(
      "sep=,\r\nCUSTOM.date [local],OSD.flyTime,OSD.flyTime [s],OSD.latitude,OSD.longitude,"
      "OSD.height [ft],OSD.altitude [ft],OSD.xSpeed [MPH],OSD.ySpeed [MPH],OSD.zSpeed [MPH],"
      "OSD.pitch,OSD.roll,OSD.yaw,GIMBAL.pitch,GIMBAL.roll,GIMBAL.yaw\r\n"
      "5/12/2024,0m 1s,1,46.5,6.5,100,1400,10,0,0,0,0,180,-45,0,90\r\n"
      "5/12/2024,0m 2s,2,46.5,6.5,100,1400,10,0,0,0,0,180,-45,0,90\r\n");
  EXPECT_EQ(dji.recorder, "DJI flight record");
  EXPECT_NEAR(row_of(dji, "place", 0)[2], 30.48, 1e-9);
  EXPECT_NEAR(row_of(dji, "velocity", 0)[1], 4.4704, 1e-9);
  EXPECT_NEAR(row_of(dji, "yaw", 0)[0], -M_PI / 2, 1e-9);
  Value sea = Value::map();
  sea.set("heights", "sea");
  const FlightLog from_sea = reader_named("csv", sea)
                                 ->read(
                                     "time(millisecond),latitude,longitude,height_above_takeoff(m),"
                                     "altitude_above_sealevel(m)\n"
                                     "0,46.5,6.5,10,400\n");
  EXPECT_EQ(row_of(from_sea, "place", 0)[2], 400);
  const FlightLog datcon = reader_named("csv")->read(
      "Clock:offsetTime,IMU_ATTI(0):Longitude[degrees],IMU_ATTI(0):Latitude[degrees],"
      "General:relativeHeight[meters],IMU_ATTI(0):velN[meters/Sec],IMU_ATTI(0):velE[meters/Sec],"
      "IMU_ATTI(0):velD[meters/Sec]\n0.5,6.5,46.5,12,1,2,3\n");
  EXPECT_EQ(datcon.recorder, "DatCon");
  EXPECT_EQ(row_of(datcon, "velocity", 0), Eigen::VectorXd(Eigen::Vector3d(2, 1, -3)));
}

TEST(CsvLog, ReadsItsOwnExportBack) {
  const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  const Plan plan = wave_plan(3);
  const FlightLog log = reader_named("csv")->read(registry.create<Exporter>("csv")->write(plan));
  ASSERT_EQ(log.find("position")->size(), plan.trajectory.samples.size());
  for (std::size_t i = 0; i < plan.trajectory.samples.size(); i += 7) {
    const Sample& s = plan.trajectory.samples[i];
    EXPECT_EQ(row_of(log, "position", i), Eigen::VectorXd(s.position));
    EXPECT_EQ(row_of(log, "velocity", i), Eigen::VectorXd(s.velocity));
    EXPECT_EQ(row_of(log, "camera", i)[0], s.yaw + s.gimbal_yaw);
    EXPECT_EQ(row_of(log, "camera", i)[1], s.gimbal_pitch);
  }
}

TEST(CsvLog, BadRowsAreCountedAndACutRowIsTheEnd) {
  const std::string bytes =
      "time [s],position_x [m],position_y [m],position_z [m],yaw [rad]\n0,1,2,3,0\n1,1\n2,1,2,3,0\n"
      "3,1,2";
  const FlightLog log = reader_named("csv")->read(bytes);
  EXPECT_THAT(log.damage, HasSubstr("cut short in line 5"));
  EXPECT_EQ(log.find("position")->size(), 2u);
  EXPECT_THAT(log.remarks,
              testing::ElementsAre(HasSubstr("1 lines have another number of fields")));
  EXPECT_GT(read_cut(*reader_named("csv"), airdata_of(short_flight()).substr(0, 1200)), 100u);
}

TEST(CsvLog, RefusesUnknownHeadingsAndUnits) {
  const auto reader = reader_named("csv");
  EXPECT_THAT(refusal_of(*reader, "a,b\n1,2\n"), HasSubstr("headings are not those of a flight"));
  EXPECT_THAT(
      refusal_of(*reader, "time(millisecond),latitude,longitude,altitude [parsec]\n1,2,3,4\n"),
      HasSubstr("column 'altitude' has the unit 'parsec'"));
  EXPECT_THAT(refusal_of(*reader, "time [s],position_x [m],position_y [m],position_z [m]\n"),
              HasSubstr("no row holds a time and a position"));
}

}  // namespace
}  // namespace lapwing
