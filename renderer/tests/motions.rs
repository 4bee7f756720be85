//! Motions: keys come back bit for bit, turns go the short way, shifts are known as such.

use std::f64::consts::PI;

use glam::{DAffine3, DVec3};
use renderer::math::transform::Motion;
use wide::f64x8;

#[test]
fn motions_pass_through_their_keys_the_short_way() {
    let turn = |angle| DAffine3::from_axis_angle(DVec3::Z, angle);
    let shift = DAffine3::from_translation(DVec3::X);
    let keys = vec![(1.0, turn(0.0)), (2.0, turn(1.0)), (4.0, shift)];
    let motion = Motion::keyed(keys.clone()).unwrap();
    for (time, key) in keys {
        assert_eq!(motion.at(time), key);
    }
    assert_eq!((motion.at(-9.0), motion.at(9.0)), (turn(0.0), shift));
    for (from, to, half) in [(0.0, 1.0, 0.5), (0.1, 2.0 * PI, 0.05), (0.0, 1e-9, 5e-10), (-1.0, 2.1, 0.55)] {
        let motion = Motion::keyed(vec![(0.0, turn(from)), (1.0, turn(to))]).unwrap();
        let want = turn(half).to_cols_array();
        let got = motion.at(0.5).to_cols_array();
        // A dozen roundings of numbers up to 1.
        assert!(want.iter().zip(got).all(|(a, b)| (a - b).abs() < 16.0 * f64::EPSILON), "{from} {to}");
    }
    let sheared = DAffine3::from_cols_array(&[2.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    let mirrored = DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
    let through = Motion::keyed(vec![(0.0, sheared), (1.0, sheared * turn(2.0))]).unwrap();
    for i in 0..=10 {
        assert!(through.at(f64::from(i) / 10.0).matrix3.determinant() > 0.5);
    }
    assert!(Motion::keyed(vec![(0.0, turn(0.0)), (1.0, mirrored)]).is_err());
    assert!(Motion::keyed(vec![(0.0, shift), (0.0, shift)]).is_err());
    assert!(Motion::keyed(vec![]).is_err());
    assert!(Motion::keyed(vec![(f64::NAN, shift)]).is_err());
}

#[test]
fn motions_say_how_far_they_shift_if_that_is_all() {
    let shift = |x| DAffine3::from_translation(DVec3::new(x, 1.0, -x));
    let turn = DAffine3::from_axis_angle(DVec3::Z, 1.0);
    let motion = Motion::keyed(vec![(1.0, shift(0.0)), (2.0, shift(3.0)), (4.0, shift(-1.0))]).unwrap();
    let times = [-1.0, 1.0, 1.3, 2.0, 3.7, 4.0, 9.0, 1.9];
    let eight = motion.offset_eight(f64x8::new(times)).unwrap().0.map(f64x8::to_array);
    for (lane, time) in times.into_iter().enumerate() {
        let offset = Some(motion.at(time).translation);
        assert_eq!(motion.offset(time), offset, "{time}");
        assert_eq!(Some(DVec3::from(eight.map(|axis| axis[lane]))), offset, "{time}");
    }
    let turned = Motion::keyed(vec![(0.0, shift(1.0) * turn), (1.0, shift(2.0) * turn)]).unwrap();
    assert_eq!(turned.offset(0.5), None);
    let (start, rest) = turned.shift_from(0.5).unwrap();
    assert_eq!(start, turned.at(0.5));
    assert_eq!(rest.offset(1.0), Some(DVec3::new(0.5, 0.0, -0.5)));
    let turning = Motion::keyed(vec![(0.0, shift(0.0)), (1.0, turn)]).unwrap();
    assert!(turning.offset(0.5).is_none() && turning.shift_from(0.0).is_none());
}
