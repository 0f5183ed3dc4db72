"""What a camera on the car sees of the road, and what a lane detector makes of it.

In: a `roads.network.Network` (as the quads of `roads.mesh`), the pose of the vehicle, boxes for everybody
else, weather, and sigma of the sensor noise. Out: BGR images (`road_camera.RoadCamera`), lane boundaries
with a probability each (`lane_detector.LaneDetector`) and the picture that a report shows
(`overlay.compose`).

May import `roads`, the hall, numpy and OpenCV; knows no plan, no engine, no controller. Nothing here keeps
state between
frames: an image depends on the scene, the pose, the weather, the seed and the frame index alone.
"""
