//! From a point cloud to a frame: every point to its pixel, and the camera that saw it so.
//!
//! * An *organized* cloud has a point, perhaps a missing one, for every pixel. Its camera is fitted to the points
//!   ([`fit_camera`]) or given.
//! * An *unorganized* cloud is a list. With the camera given, every point with depth goes to the pixel that sees it,
//!   u = round(fx·x/z + cx), v = round(fy·y/z + cy); points outside the image are dropped, and of two points in a pixel
//!   the later one stays. Pixels without a point have no depth, colour 0 and label 0.
//!   Without a camera it gets a virtual one that fits the points, and of two points in a pixel the
//!   nearer one stays. Either way, a [`PointList`] tells the label of every point.
//!
//! A point is missing when a coordinate is not finite or z is not positive; its label becomes 0. Depth is the z of the
//! point, bit by bit. Only depth and camera are kept, not x and y.
//!
//! Some files (a still of the Point Cloud Library's tutorials among them) have the frame of computer graphics: x right,
//! y up, z backward. Then not one point lies in front of the camera, and the cloud is turned by half about x.

mod fit;
mod focal;
mod grid_camera;
mod lattice;
mod list;
mod virtual_view;

pub use fit::{CameraFit, MAX_RESIDUAL_PX, fit_camera};
pub use grid_camera::GridCamera;
pub use list::PointList;

use objecthood::{Camera, Frame, Raster};

use list::Shown;
use virtual_view::HALF_TURN;

use crate::capture::{Capture, Pose};
use crate::cloud::PointCloud;
use crate::error::{Error, Result};
use crate::given::Given;
use crate::images::check_pixels;

/// Puts a cloud on the pixel grid. The camera of an organized cloud is fitted unless it is given; its size is then the
/// cloud's. A list of points without a camera gets a virtual one. O(points).
///
/// # Errors
/// * organized: those of [`fit_camera`] without a camera, [`Error::CameraSize`] with one of another size;
/// * a list: [`Error::NoView`] without a camera when the points span too much, [`Error::NothingInView`] with a wrong
///   one, [`Error::NoImageSize`] when its size is neither given nor implied;
/// * both: [`Error::CloudLengths`], [`Error::Image`] with `TooManyPixels`, [`Error::Frame`] with `NoValidDepth` when no
///   point is valid.
pub fn organize(cloud: PointCloud, given: &Given) -> Result<Capture> {
    cloud.check()?;
    let capture =
        if cloud.is_organized() { organize_grid(cloud, given) } else { organize_list(cloud, given) }?;
    Ok(Capture { is_metric: true, ..capture })
}

fn organize_grid(mut cloud: PointCloud, given: &Given) -> Result<Capture> {
    let turned = face_forward(&mut cloud.points_m);
    check_pixels((cloud.width, cloud.height), given.max_pixels)?;
    let capture = match given.camera {
        None => {
            let fit = fit_camera(&cloud)?;
            keep_grid(cloud, fit.camera, Some(fit))
        }
        Some(camera) => match camera.size {
            Some(size) if size != (cloud.width, cloud.height) => {
                Err(Error::CameraSize { given: size, cloud: (cloud.width, cloud.height) })
            }
            _ => keep_grid(cloud, camera.camera, None),
        },
    }?;
    Ok(Capture { turned, ..capture })
}

fn organize_list(cloud: PointCloud, given: &Given) -> Result<Capture> {
    let points_m = &cloud.points_m;
    let (grid, pose, shown) = match given.camera {
        Some(camera) => {
            // The points do not tell how many pixels there are: the camera does, and it may come from a file.
            check_pixels(camera.image_size()?, given.max_pixels)?;
            let is_forward = points_m.iter().any(|&point| is_valid(point));
            (camera, if is_forward { Pose::ORIGIN } else { HALF_TURN }, Shown::Last)
        }
        None => {
            let is_there = |point: &[f32; 3]| point.iter().all(|part| part.is_finite()) && *point != [0.0; 3];
            if !points_m.iter().any(is_there) {
                let size = (cloud.width, cloud.height);
                return Err(objecthood::Error::NoValidDepth { size }.into());
            }
            let (grid, pose) = virtual_view::choose(points_m, cloud.viewpoint, given.max_pixels)?;
            (grid, pose, Shown::Nearest)
        }
    };
    let capture = list::place(cloud, &grid, pose, shown)?;
    let pose = (pose != Pose::ORIGIN).then_some(pose);
    Ok(Capture { turned: pose == Some(HALF_TURN), pose: pose.or(capture.pose), ..capture })
}

/// Turns points by half about x unless one of them lies in front of the camera; says whether it did.
fn face_forward(points_m: &mut [[f32; 3]]) -> bool {
    let turns = !points_m.iter().any(|&point| is_valid(point));
    if turns {
        points_m.iter_mut().for_each(|[_, y, z]| (*y, *z) = (-*y, -*z));
    }
    turns
}

/// Whether a point was seen.
fn is_valid([x, y, z]: [f32; 3]) -> bool {
    x.is_finite() && y.is_finite() && z.is_finite() && z > 0.0
}

fn keep_grid(cloud: PointCloud, camera: Camera, camera_fit: Option<CameraFit>) -> Result<Capture> {
    let PointCloud { width, height, points_m, color, label, .. } = cloud;
    let depth_m = points_m.iter().map(|&point| if is_valid(point) { point[2] } else { f32::NAN });
    let depth_m = Raster::from_vec(width, height, depth_m.collect())?;
    let color = color.map(|color| Raster::from_vec(width, height, color)).transpose()?;
    let truth = label.map(|mut label| {
        let missing = label.iter_mut().zip(&points_m).filter(|(_, point)| !is_valid(**point));
        missing.for_each(|(label, _)| *label = 0);
        Raster::from_vec(width, height, label)
    });
    let truth = truth.transpose()?;
    Ok(Capture { truth, camera_fit, ..Capture::new(Frame::new(depth_m, color, camera)?) })
}

/// The pixel nearest to `x` of `count`, ties to even; `None` outside and for NaN.
fn nearest(x: f64, count: usize) -> Option<usize> {
    let x = x.round_ties_even();
    (x >= 0.0 && x < count as f64).then_some(x as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAN: [f32; 3] = [f32::NAN; 3];

    fn organize(cloud: PointCloud, camera: Option<&GridCamera>) -> Result<Capture> {
        super::organize(cloud, &Given { camera: camera.copied(), max_pixels: 48, ..Given::default() })
    }

    fn camera() -> Camera {
        Camera::new(10.0, 12.0, 3.5, 2.5).unwrap()
    }

    /// 8 x 6 points on a slanted plane, one of them missing.
    fn organized() -> PointCloud {
        let pixel = |i: usize| camera().back_project(i % 8, i / 8, 1.0 + i as f32 / 100.0);
        let mut points_m: Vec<_> = (0..48).map(pixel).collect();
        points_m[7] = NAN;
        let color = (0..48).map(|i| [i as u8, 1, 2]).collect();
        PointCloud {
            width: 8,
            height: 6,
            points_m,
            color: Some(color),
            label: Some((100..148).collect()),
            viewpoint: None,
        }
    }

    fn flattened(cloud: &PointCloud, keep: impl Fn([f32; 3]) -> bool) -> PointCloud {
        let kept: Vec<usize> = (0..cloud.points_m.len()).filter(|&i| keep(cloud.points_m[i])).collect();
        PointCloud {
            width: kept.len(),
            height: 1,
            points_m: kept.iter().map(|&i| cloud.points_m[i]).collect(),
            color: cloud.color.as_ref().map(|color| kept.iter().map(|&i| color[i]).collect()),
            label: cloud.label.as_ref().map(|label| kept.iter().map(|&i| label[i]).collect()),
            viewpoint: None,
        }
    }

    fn bits(frame: &Frame) -> Vec<u32> {
        frame.depth_m().as_slice().iter().map(|z| z.to_bits()).collect()
    }

    #[test]
    fn an_organized_cloud_keeps_depth_colour_and_label() {
        let cloud = organized();
        let capture = organize(cloud.clone(), None).unwrap();
        assert_eq!(capture.frame.size(), (8, 6));
        assert_eq!(capture.frame.depth_m()[20], cloud.points_m[20][2]);
        assert!(capture.frame.depth_m()[7].is_nan());
        assert_eq!(capture.frame.color().unwrap()[7], [7, 1, 2]);
        let truth = capture.truth.unwrap();
        assert_eq!((truth[6], truth[7], truth[8]), (106, 0, 108));
        assert!((capture.frame.camera().fx_px - 10.0).abs() < 1e-4);
        assert!(capture.camera_fit.unwrap().residual_px < 1e-4);
    }

    #[test]
    fn a_given_camera_replaces_the_fit() {
        let other = Camera::new(20.0, 20.0, 0.0, 0.0).unwrap();
        for size in [None, Some((8, 6))] {
            let capture = organize(organized(), Some(&GridCamera { camera: other, size })).unwrap();
            assert_eq!(capture.frame.camera(), other);
            assert!(capture.camera_fit.is_none());
        }
        let wrong = GridCamera { camera: other, size: Some((6, 8)) };
        assert!(matches!(organize(organized(), Some(&wrong)), Err(Error::CameraSize { .. })));
    }

    #[test]
    fn a_flattened_cloud_comes_back_to_its_grid() {
        let cloud = organized();
        let grid = organize(cloud.clone(), None).unwrap();
        for list in [flattened(&cloud, |_| true), flattened(&cloud, is_valid)] {
            let again = organize(list, Some(&GridCamera { camera: camera(), size: None })).unwrap();
            assert_eq!(bits(&again.frame), bits(&grid.frame));
            assert_eq!(again.truth, grid.truth);
            assert_eq!(again.frame.color().unwrap()[7], [0; 3], "no point, no colour");
            assert_eq!(again.frame.color().unwrap()[8], [8, 1, 2]);
        }
    }

    #[test]
    fn a_cloud_in_the_frame_of_graphics_is_turned() {
        let cloud = organized();
        let mut graphics = cloud.clone();
        graphics.points_m.iter_mut().for_each(|point| *point = [point[0], -point[1], -point[2]]);
        let given = GridCamera { camera: camera(), size: None };
        for camera in [None, Some(&given)] {
            let (plain, turned) =
                (organize(cloud.clone(), camera).unwrap(), organize(graphics.clone(), camera).unwrap());
            assert_eq!(bits(&turned.frame), bits(&plain.frame));
            assert_eq!(turned.camera_fit, plain.camera_fit);
            assert!(turned.turned && !plain.turned);
        }
        // Points behind the camera are missing as long as one is in front of it.
        graphics.points_m[20] = cloud.points_m[20];
        let mixed = organize(graphics, Some(&given)).unwrap();
        assert_eq!((0..48).filter(|&i| mixed.frame.is_valid(i)).collect::<Vec<_>>(), [20]);
    }

    #[test]
    fn the_later_point_stays_and_the_outside_is_dropped() {
        let points_m =
            vec![[0.0, 0.0, 1.0], [0.0, 0.0, 2.0], [100.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.0, f32::NAN, 5.0]];
        let cloud = PointCloud {
            width: 5,
            height: 1,
            points_m,
            color: None,
            label: Some(vec![1, 2, 3, 4, 5]),
            viewpoint: None,
        };
        let given = GridCamera { camera: Camera::new(1.0, 1.0, 1.0, 0.0).unwrap(), size: Some((2, 1)) };
        let capture = organize(cloud, Some(&given)).unwrap();
        assert_eq!(capture.frame.depth_m()[1], 2.0);
        assert!(capture.frame.depth_m()[0].is_nan());
        assert_eq!(capture.truth.unwrap().as_slice(), [0, 2]);
        assert!(capture.frame.color().is_none());
    }

    #[test]
    fn an_unorganized_cloud_needs_a_fitting_camera() {
        let list = flattened(&organized(), is_valid);
        let said = |camera: Option<GridCamera>| organize(list.clone(), camera.as_ref()).unwrap_err();
        assert!(
            organize(list.clone(), None)
                .is_ok_and(|capture| capture.list.is_some_and(|list| list.is_virtual))
        );
        let far = Camera::new(10.0, 10.0, -500.0, 2.5).unwrap();
        assert!(matches!(said(Some(GridCamera { camera: far, size: None })), Error::NoImageSize { .. }));
        let aside = GridCamera { camera: far, size: Some((8, 6)) };
        assert!(matches!(said(Some(aside)), Error::NothingInView { points: 47, .. }));
    }

    /// `--camera 131,131,79.5,59.5,16384,16384` made room for them before it asked for `--max-pixels`.
    #[test]
    fn a_camera_of_many_pixels_is_refused() {
        let given = GridCamera { camera: camera(), size: Some((7, 7)) };
        for (cloud, camera) in [
            (flattened(&organized(), is_valid), Some(&given)),
            (
                PointCloud {
                    width: 49,
                    height: 1,
                    points_m: vec![NAN; 49],
                    color: None,
                    label: None,
                    viewpoint: None,
                },
                Some(&given),
            ),
            (
                PointCloud {
                    width: 7,
                    height: 7,
                    points_m: vec![NAN; 49],
                    color: None,
                    label: None,
                    viewpoint: None,
                },
                None,
            ),
        ] {
            let error = organize(cloud, camera).unwrap_err();
            assert!(error.to_string().starts_with("7x7 pixels are more than the 48"), "{error}");
        }
    }

    #[test]
    fn no_valid_point_is_told_in_every_way_of_opening() {
        let given = GridCamera { camera: camera(), size: None };
        for (width, height) in [(4, 2), (8, 1), (1, 8), (1, 1)] {
            for bad in [NAN, [0.0; 3], [0.0, 0.0, f32::INFINITY]] {
                let points_m = vec![bad; width * height];
                let cloud = PointCloud { width, height, points_m, color: None, label: None, viewpoint: None };
                let given = (height == 1 && width > 1).then_some(&given);
                let error = organize(cloud, given).unwrap_err();
                assert!(error.blank_size().is_some(), "{error}");
            }
        }
    }

    #[test]
    fn pixels_are_rounded_and_bounded() {
        assert_eq!(nearest(-0.5, 3), Some(0));
        assert_eq!(nearest(-0.51, 3), None);
        assert_eq!(nearest(2.49, 3), Some(2));
        assert_eq!(nearest(2.51, 3), None);
        assert_eq!(nearest(f64::NAN, 3), None);
        assert_eq!(nearest(f64::INFINITY, 3), None);
    }
}
