//! Maps of roads that GNSS does not see.

use host_sim::simulator::truck::Preset;
use host_sim::study::bridges::tunnel_rmse_percent;

#[test]
fn one_run_maps_a_tunnel_of_two_kilometres() {
    for truck in [Preset::A, Preset::B] {
        let rmse_percent = tunnel_rmse_percent(2011, truck).expect("a drive");
        assert!(rmse_percent <= 0.2, "{truck:?}: {rmse_percent} %");
    }
}
