use openusd::sdf;
use openusd::usd::{Prim, Stage, TimeCode};
fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    s.split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-9
}
#[test]
#[ignore]
fn probe() {
    let (_dir, path) = super::walk_time::write(false);
    let t = cpu();
    let stage =
        Stage::builder().schema_registry(openusd_schemas::schema_registry()).open(&path.to_string_lossy()).unwrap();
    println!("open {:.3}", cpu() - t);
    let t = cpu();
    let mut all = Vec::new();
    let mut stack = vec![stage.prim(sdf::Path::abs_root()).unwrap()];
    while let Some(p) = stack.pop() {
        stack.extend(p.children().unwrap());
        all.push(p);
    }
    println!("children {:.3} {}", cpu() - t, all.len());
    let time = |what: &str, f: &dyn Fn(&Prim)| {
        let t = cpu();
        all.iter().skip(1).for_each(f);
        println!("{what} {:.3}", cpu() - t);
    };
    time("has_clips", &|p| {
        p.has_clips().unwrap();
    });
    time("get unauthored", &|p| {
        p.attribute("normals").get_at::<sdf::Value>(TimeCode::new(0.0)).unwrap();
    });
    time("get unauthored fallback", &|p| {
        p.attribute("orientation").get_at::<sdf::Value>(TimeCode::new(0.0)).unwrap();
    });
    time("definition", &|p| {
        p.prim_definition().unwrap().attribute_fallback(&openusd::tf::Token::from("orientation"));
    });
    time("children again", &|p| {
        p.child_names().unwrap();
    });
    time("specifier", &|p| {
        p.specifier().unwrap();
    });
    time("active", &|p| {
        p.is_active().unwrap();
    });
    time("active meta", &|p| {
        p.stage().field::<bool>(p.path(), "active").unwrap();
    });
    time("type", &|p| {
        p.type_name().unwrap();
    });
    time("names", &|p| {
        p.authored_property_names().unwrap();
    });
    time("is_instance", &|p| {
        p.is_instance().unwrap();
    });
    time("status", &|p| {
        p.stage().prim_status(p.path()).unwrap();
    });
    time("api", &|p| {
        p.has_api_schema("LightAPI").unwrap();
    });
    time("type info", &|p| {
        p.prim_type_info().unwrap();
    });
    time("order", &|p| {
        p.attribute("xformOpOrder").get::<Vec<openusd::tf::Token>>().unwrap();
    });
    time("is_defined", &|p| {
        p.attribute("xformOp:translate").is_defined().unwrap();
    });
    time("get_at", &|p| {
        p.attribute("xformOp:translate").get_at::<sdf::Value>(TimeCode::new(0.0)).unwrap();
    });
    time("query get_at", &|p| {
        p.attribute("xformOp:translate").query().get_at::<sdf::Value>(TimeCode::new(0.0)).unwrap();
    });
    time("bracket", &|p| {
        p.attribute("xformOp:translate").bracketing_time_samples(TimeCode::new(0.0)).unwrap();
    });
    time("xformquery", &|p| {
        openusd_schemas::geom::XformQuery::for_prim(p).unwrap().local_transformation(TimeCode::new(0.0)).unwrap();
    });
    time("points", &|p| {
        p.attribute("points").get_at::<sdf::Value>(TimeCode::new(0.0)).unwrap();
    });
    let other =
        Stage::builder().schema_registry(openusd_schemas::schema_registry()).open(&path.to_string_lossy()).unwrap();
    let t = cpu();
    let mut n = 0;
    other.traverse(openusd::usd::PrimPredicate::DEFAULT, |_| n += 1).unwrap();
    println!("traverse {:.3} {n}", cpu() - t);
    let t = cpu();
    other.traverse(openusd::usd::PrimPredicate::DEFAULT, |_| n += 1).unwrap();
    println!("traverse again {:.3} {n}", cpu() - t);
    let t = cpu();
    drop((all, stack));
    drop(stage);
    println!("drop {:.3}", cpu() - t);
}
