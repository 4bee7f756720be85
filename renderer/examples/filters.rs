//! Writes the pixel filters' values as CSV, for `scripts/compare_oiio.py --filters` to hold against OpenImageIO's.

use renderer::film::Filter;

/// Distances from the middle to the filter's end, in steps.
const STEPS: u32 = 64;

fn main() {
    let filters = [
        ("box", Filter::PIXEL),
        ("tent", Filter::Tent { radius: 1.0 }),
        ("gaussian", Filter::Gaussian { stddev: 0.5 }),
        ("mitchell", Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }),
    ];
    println!("filter,radius,x,value");
    for (name, filter) in filters {
        let radius = filter.radius();
        for step in 0..STEPS {
            let x = radius * f64::from(step) / f64::from(STEPS);
            println!("{name},{radius},{x},{}", filter.eval(x));
        }
    }
}
