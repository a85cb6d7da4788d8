//! Variants of the 19 x 62 pinion of which there are tables.

/// Settings found by an ease-off identification: offset, sliding base, modified roll and a curved blade.
pub const EASE_OFF: [(&str, &str); 11] = [
    ("m.radial_distance", "99.808 mm"),
    ("m.work_offset", "-1.8799 mm"),
    ("m.sliding_base", "-1.3231 mm"),
    ("m.cradle_angle", "-51.522 deg"),
    ("m.machine_center_to_crossing_point", "4.9987 mm"),
    ("m.ratio_of_roll", "3.4108"),
    ("m.modified_roll_2c", "0.092298"),
    ("m.modified_roll_6d", "-0.27878"),
    ("c.outside_point_radius", "98.691 mm"),
    ("c.blade_radius", "233.84 mm"),
    ("c.blade_angle", "19.882 deg"),
];

/// Every joint follows the roll.
pub const ALL_JOINTS: [(&str, &str); 22] = [
    ("m.cutter_tilt", "-2.5 deg"),
    ("m.cutter_swivel", "20 deg"),
    ("m.work_offset", "-1.5 mm"),
    ("m.sliding_base", "0.8 mm"),
    ("m.machine_center_to_crossing_point", "-0.6 mm"),
    ("m.modified_roll_2c", "0.03"),
    ("m.modified_roll_6d", "-0.12"),
    ("m.modified_roll_24e", "0.5"),
    ("m.modified_roll_120f", "-2.0"),
    ("m.helical_motion_1", "1.2 mm"),
    ("m.helical_motion_2", "-3 mm"),
    ("m.helical_motion_3", "4 mm"),
    ("m.vertical_motion_1", "0.7 mm"),
    ("m.vertical_motion_2", "-2 mm"),
    ("m.radial_motion_1", "-0.9 mm"),
    ("m.radial_motion_2", "2.5 mm"),
    ("m.radial_motion_3", "-6 mm"),
    ("m.tilt_motion_1", "0.01 rad"),
    ("m.tilt_motion_2", "-0.03 rad"),
    ("m.swivel_motion_1", "0.02 rad"),
    ("m.swivel_motion_2", "0.05 rad"),
    ("c.blade_radius", "250 mm"),
];
