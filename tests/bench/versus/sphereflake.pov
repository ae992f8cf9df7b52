#version 3.7;
#declare Depth = 6; // the first hit counts
#include "camera.inc"
Eye(<2.6, -3.4, 2.2>, <0, 0, 0.1>, 36)
background { rgb <0.3, 0.45, 0.7> }
light_source { <4, -6, 8> rgb 0.9 }
light_source { <-6, -3, 5> rgb 0.3 }
#declare Metal = texture { pigment { rgb <1, 0.8, 0.5> }
  finish { ambient 0 diffuse 0.4 specular 0.5 roughness 1 / 50 reflection { rgb 0.5 * <1, 0.8, 0.5> } } }
polygon { 5, <-50, -50, -1.6>, <50, -50, -1.6>, <50, 50, -1.6>, <-50, 50, -1.6>, <-50, -50, -1.6>
  texture { pigment { rgb 0.7 } finish { ambient 0 diffuse 0.8 } } }
#declare Half = sqrt(3) / 2;
#declare Slant = sqrt(2 / 3);
#declare Rise = sqrt(1 / 3);
#declare Ring = array[12][2] {{1, 0}, {Half, 0.5}, {0.5, Half}, {0, 1}, {-0.5, Half}, {-Half, 0.5},
  {-1, 0}, {-Half, -0.5}, {-0.5, -Half}, {0, -1}, {0.5, -Half}, {Half, -0.5}}
// As in plugins/shapes/sphereflake.cpp.
#macro Grow(Center, Radius, W, Levels)
  sphere { Center, Radius }
  #if (Levels > 1)
    #local Sign = (W.z < 0 ? -1 : 1);
    #local A = -1 / (Sign + W.z);
    #local B = W.x * W.y * A;
    #local U = <1 + Sign * W.x * W.x * A, Sign * B, -Sign * W.x>;
    #local V = <B, Sign + W.y * W.y * A, -W.y>;
    #local I = 0;
    #while (I < 12)
      #local D = vnormalize(U * Ring[I][0] + V * Ring[I][1]);
      Grow(Center + D * (Radius * 4 / 3), Radius / 3, D, Levels - 1)
      #local I = I + 2;
    #end
    #local I = 1;
    #while (I < 12)
      #local D = vnormalize(U * (Slant * Ring[I][0]) + V * (Slant * Ring[I][1]) + W * Rise);
      Grow(Center + D * (Radius * 4 / 3), Radius / 3, D, Levels - 1)
      #local I = I + 4;
    #end
  #end
#end
union { Grow(<0, 0, 0>, 0.8, <0, 0, 1>, 6) texture { Metal } }
