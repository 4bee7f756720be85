//! Integrators.

use super::Context;
use super::object::Object;
use crate::Error;
use crate::lights::LightSampling;
use crate::scene::{Branch, IntegratorSettings};

const PLUGINS: [&str; 3] = ["direct", "distribution", "path"];

/// The integrator at `index` of the document; a path tracer where there is none.
pub(super) fn read(context: &Context, index: Option<usize>) -> Result<IntegratorSettings, Error> {
    let Some(index) = index else {
        context.note("the scene has no <integrator>: paths of any length are followed".into());
        return Ok(IntegratorSettings::PATH);
    };
    let object = Object::new(context, index)?;
    let settings = match object.plugin(&PLUGINS)? {
        "direct" => direct(&object)?,
        "distribution" => IntegratorSettings {
            branch: object.choice("branch", &Branch::ALL, Branch::Both)?,
            ..path(&object)?
        },
        _ => path(&object)?,
    };
    object.finish()?;
    Ok(settings)
}

fn path(object: &Object) -> Result<IntegratorSettings, Error> {
    let max_depth = match object.integer("max_depth")? {
        None | Some(-1) => None,
        Some(depth) => Some(u32::try_from(depth).map_err(|_| {
            let accepted = "-1 for no limit, or 0 to 4294967295, is accepted";
            object.refuse_value("max_depth", format!("'max_depth' is {depth}; {accepted}"))
        })?),
    };
    let rr_depth = object.count("rr_depth", [1, u32::MAX], IntegratorSettings::PATH.rr_depth)?;
    let hide_emitters = object.boolean("hide_emitters", false)?;
    let light_sampling = light_sampling(object)?;
    Ok(IntegratorSettings { max_depth, rr_depth, light_sampling, hide_emitters, ..IntegratorSettings::PATH })
}

fn direct(object: &Object) -> Result<IntegratorSettings, Error> {
    for name in ["shading_samples", "emitter_samples", "bsdf_samples"] {
        object.count(name, [1, 1], 1)?;
    }
    let hide_emitters = object.boolean("hide_emitters", false)?;
    let light_sampling = light_sampling(object)?;
    Ok(IntegratorSettings { light_sampling, hide_emitters, ..IntegratorSettings::DIRECT })
}

fn light_sampling(object: &Object) -> Result<LightSampling, Error> {
    object.choice("light_sampling", &LightSampling::ALL, LightSampling::Auto)
}
